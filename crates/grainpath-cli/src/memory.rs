//! The memory that this process uses, the memory of the machine, and its limit.

/// Peak resident memory of the process, rounded to 0.1 MiB; 0 if the system does not report it.
pub fn peak_rss_mb() -> f64 {
    // Source: proc(5), `VmHWM` in KiB. The peak is used, since a plan frees its memory stage by stage and
    // the present value would be too low.
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:"));
    let kib = line.and_then(|l| l.split_whitespace().next()).and_then(|n| n.parse::<f64>().ok());
    // 102.4 KiB are a tenth of a MiB.
    (kib.unwrap_or(0.0) / 102.4).round() / 10.0
}

/// The value of a row of `/proc/meminfo`, MiB; `None` on systems without that file. Source: proc(5), in KiB.
pub(crate) fn of_machine(row: &str) -> Option<f64> {
    let table = std::fs::read_to_string("/proc/meminfo").ok()?;
    let line = table.lines().find_map(|l| l.strip_prefix(row)?.strip_prefix(':'))?;
    line.split_whitespace().next()?.parse::<f64>().ok().map(|kib| kib / 1024.0)
}

/// The memory limit of the control group, MiB; `None` without a limit. Source: cgroups(7), version 2, bytes.
pub(crate) fn limit_mib() -> Option<f64> {
    let text = std::fs::read_to_string("/sys/fs/cgroup/memory.max").ok()?;
    text.trim().parse::<f64>().ok().map(|bytes| bytes / f64::from(1 << 20))
}
