//! The memory that this process uses.

/// Peak resident memory of the process, MiB to a tenth; 0 where the system gives none.
pub fn peak_rss_mb() -> f64 {
    // Source: proc(5), `VmHWM` in KiB. The peak and not the present value, since a plan frees its memory
    // stage by stage.
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:"));
    let kib = line.and_then(|l| l.split_whitespace().next()).and_then(|n| n.parse::<f64>().ok());
    // 102.4 KiB are a tenth of a MiB.
    (kib.unwrap_or(0.0) / 102.4).round() / 10.0
}
