//! Finite-element files on the command line.

mod support;

use support::{folder, grainpath, json, shared};

const TABLE: &str = "x,y,sxx,syy,sxy\n0,0,1,2,3\n10,0,4,5,6\n0,10,7,8,9\n";

#[test]
fn inspect_tells_what_a_result_is() {
    let dir = folder("fe-inspect");
    std::fs::write(dir.join("a.csv"), TABLE).expect("a table");
    let seen = json(&grainpath(&dir, &["inspect", "a.csv", "--json"]));
    assert_eq!((seen["kind"].as_str(), seen["format"].as_str()), (Some("fe"), Some("CSV")));
    assert_eq!((seen["nodes"].as_u64(), seen["plane"].as_bool()), (Some(3), Some(true)));
    let text = grainpath(&dir, &["inspect", "a.csv"]);
    assert!(String::from_utf8_lossy(&text.stdout).contains("max von mises"));
    std::fs::write(dir.join("b.csv"), TABLE.replace("4,5", "4;5")).expect("a table");
    let refused = grainpath(&dir, &["inspect", "b.csv"]);
    assert_eq!(refused.status.code(), Some(3));
    assert!(String::from_utf8_lossy(&refused.stderr).contains("b.csv: line 3: "));
}

#[test]
fn inspect_reads_real_results() {
    let Some(shared) = shared() else { return };
    let data = shared.join("data/fea");
    let inspect = |file: &str| grainpath(&data, &["inspect", file, "--json"]);
    let plate = json(&inspect("plate_hole_linear.vtu"));
    assert_eq!((plate["nodes"].as_u64(), plate["elements"]["tet10"].as_u64()), (Some(13234), Some(6524)));
    assert!((plate["max_von_mises"].as_f64().expect("a stress") - 570.76).abs() < 0.01);
    let beams = json(&inspect("ccx_uprofile.inp"));
    assert_eq!(beams["left_out"]["beams and trusses"].as_u64(), Some(5));
    let step = inspect("bracket.step");
    assert_eq!(step.status.code(), Some(3));
    assert!(String::from_utf8_lossy(&step.stderr).contains("STEP"));
}
