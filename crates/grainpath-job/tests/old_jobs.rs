//! Jobs of released versions can still be read and keep their meaning.

use grainpath_core::WarningId;
use grainpath_job::parse_job;

fn jobs(release: &str) -> Vec<(String, String)> {
    let folder = format!("{}/tests/jobs-{release}", env!("CARGO_MANIFEST_DIR"));
    let mut jobs: Vec<(String, String)> = std::fs::read_dir(&folder)
        .expect("the jobs of the release")
        .map(|entry| {
            let path = entry.expect("an entry").path();
            let text = std::fs::read_to_string(&path).expect("a job in UTF-8");
            (path.file_name().expect("a name").to_string_lossy().into_owned(), text)
        })
        .collect();
    jobs.sort();
    jobs
}

#[test]
fn jobs_of_0_1_0_are_read() {
    let jobs = jobs("0.1.0");
    assert!(jobs.len() > 30, "{} jobs", jobs.len());
    for (name, text) in jobs {
        let no_files = |path: &str| Err(format!("{path}: the presets use shipped profiles only"));
        let settings = parse_job(&text, &name, &[], &no_files).unwrap_or_else(|e| panic!("{e}"));
        for warning in settings.warnings {
            let known = [WarningId::JobRenamed, WarningId::JobRemoved].contains(&warning.id);
            assert!(known, "{name}: {warning}");
        }
    }
}

/// The file that sets each key to its default of 0.1.0 gives the settings of an empty job: neither a
/// default nor the meaning of a word has changed since.
#[test]
fn defaults_of_0_1_0_are_still_the_defaults() {
    let no_files = |path: &str| Err(path.to_owned());
    let (name, text) = jobs("0.1.0").into_iter().find(|j| j.0 == "every-setting.toml").expect("the file");
    // Profiles are weaker than the file, so the comparison is with the settings without a profile.
    let mut written = parse_job(&text, &name, &[], &no_files).expect("a sound job");
    let key_of = |text: &str| text.split(' ').next().unwrap_or_default().to_owned();
    let mut told: Vec<(WarningId, String)> =
        written.warnings.iter().map(|w| (w.id, key_of(&w.text))).collect();
    told.sort_unstable_by_key(|(id, key)| (id.name(), key.clone()));
    let expected = [
        (WarningId::JobRemoved, "support.brace"),
        (WarningId::JobRemoved, "support.brace_slenderness"),
        (WarningId::JobRenamed, "guide.memory_mb"),
    ];
    assert_eq!(told, expected.map(|(id, key)| (id, key.to_owned())));
    written.warnings.clear();
    let rows = |s: &grainpath_job::Settings| {
        let mut rows = s.rows();
        // The profile of the default material gives strengths, which have no default of their own.
        rows.retain(|r| !["_mpa", "_n_mm", "_source"].iter().any(|end| r.key.ends_with(end)));
        rows
    };
    let defaults = grainpath_job::Settings::default();
    let changed: Vec<_> = rows(&written).into_iter().zip(rows(&defaults)).filter(|(a, b)| a != b).collect();
    assert!(changed.is_empty(), "{changed:#?}");
}
