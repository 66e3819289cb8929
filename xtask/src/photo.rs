//! A photograph of 12 megapixels to curves: ours beside OpenCV, in one run on the same file.

use std::fs;
use std::process::Command;

use serde_json::Value;

/// Makes the photograph from the example's and times OpenCV: decode, warp, blur, Canny, contours, best of five.
const OPENCV: &str = r#"
import json, sys, time
import cv2
import numpy as np

board, target = sys.argv[1:3]
small = cv2.imread(board)
scale = 6000 / small.shape[1]
big = cv2.resize(small, None, fx=scale, fy=scale, interpolation=cv2.INTER_CUBIC).astype(np.int16)
big += np.random.default_rng(1).normal(0, 4, big.shape).astype(np.int16)
cv2.imwrite(target, np.clip(big, 0, 255).astype(np.uint8), [cv2.IMWRITE_JPEG_QUALITY, 92])
data = np.frombuffer(open(target, "rb").read(), np.uint8)
corners = np.float32([[52, 58], [842, 44], [868, 258], [34, 244]]) * scale
width, height = 5400, 1350
flat = np.float32([[0, 0], [width, 0], [width, height], [0, height]])
best = 1e9
for _ in range(5):
    start = time.perf_counter()
    image = cv2.imdecode(data, cv2.IMREAD_COLOR)
    warped = cv2.warpPerspective(image, cv2.getPerspectiveTransform(corners, flat), (width, height))
    soft = cv2.GaussianBlur(cv2.cvtColor(warped, cv2.COLOR_BGR2GRAY), (0, 0), 5)
    cv2.findContours(cv2.Canny(soft, 20, 50), cv2.RETR_LIST, cv2.CHAIN_APPROX_NONE)
    best = min(best, time.perf_counter() - start)
print(json.dumps({"s": best, "version": cv2.__version__, "megapixels": big.shape[0] * big.shape[1] / 1e6}))
"#;

/// Runs both and prints the ratio.
pub fn bench() -> Result<(), String> {
    crate::setup::opencv()?;
    crate::cargo(&["build", "--release", "-p", "grainpath-cli"])?;
    let root = crate::root();
    let folder = root.join("target/bench-photo");
    fs::create_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let (board, photo) = (root.join("examples/woodgrain/board.png"), folder.join("board.jpg"));
    let theirs = crate::output(crate::setup::python().args(["-c", OPENCV]).args([&board, &photo]))?;
    let theirs: Value = serde_json::from_str(&theirs).map_err(|e| format!("OpenCV: {e}"))?;
    let job = "[shape.photo]\nfiles = [\"board.jpg\"]\ncorners_px = [[347, 387], [5613, 293], [5787, 1720], [227, 1627]]\n\
               size_mm = [120, 30]\nthickness_mm = 4\n[guide]\nkind = \"grain\"\nmode = \"edges\"\n\
               [fill]\ndensity = 0.4\n[output]\ngcode = \"out.gcode\"\n";
    fs::write(folder.join("job.toml"), job).map_err(|e| format!("{}: {e}", folder.display()))?;
    let mut best: Option<[f64; 3]> = None;
    for _ in 0..5 {
        let mut command = Command::new(crate::built("grainpath"));
        let report = crate::output(command.arg("run").arg(folder.join("job.toml")).arg("--json"))?;
        let report: Value = serde_json::from_str(&report).map_err(|e| format!("grainpath: {e}"))?;
        let stages = report["stages_s"].as_object().ok_or("a report without stages")?;
        let of = |name: &str| stages.get(name).and_then(Value::as_f64).unwrap_or(0.0);
        let whole: f64 = stages.values().filter_map(Value::as_f64).sum();
        let run = [of("read"), of("guide"), whole];
        if best.is_none_or(|b| run[0] + run[1] < b[0] + b[1]) {
            best = Some(run);
        }
    }
    let [read, guide, whole] = best.ok_or("no run")?;
    let opencv = theirs["s"].as_f64().ok_or("no time")?;
    println!("\n{:.1} megapixels, best of five.\n", theirs["megapixels"].as_f64().unwrap_or(0.0));
    println!("| | s |\n|---|---|");
    println!("| OpenCV {}: decode, warp, blur, Canny, contours | {opencv:.3} |", theirs["version"]);
    println!("| grainpath: decode | {read:.3} |");
    println!("| grainpath: warp, blur, Canny, curves, directions | {guide:.3} |");
    println!("| grainpath / OpenCV | {:.2} |", (read + guide) / opencv);
    println!("| photograph to G-code, 20 layers | {whole:.2} |");
    Ok(())
}
