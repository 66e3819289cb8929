//! Job files.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    if let Ok(text) = std::str::from_utf8(bytes) {
        let _ = grainpath_job::parse_job(text, "job.toml", &[], &|_| Err("no files here".to_owned()));
        let _ = grainpath_job::parse_job("", "job.toml", &[text.to_owned()], &|_| {
            Err("no files here".to_owned())
        });
    }
});
