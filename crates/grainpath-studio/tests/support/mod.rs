//! A studio without a port, and requests to it.
#![allow(dead_code)]

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use axum::Router;
use axum::body::Body;
use axum::http::{HeaderMap, Request, StatusCode};
use grainpath::run::{Inputs, plan_job};
use grainpath_core::Diagnostics;
use grainpath_gcode::{Limits, Program, simulate, write_gcode};
use grainpath_io::parse_mesh;
use grainpath_job::parse_job;
use grainpath_studio::roots::Roots;
use grainpath_studio::{
    Branch, CaseValues, Engine, Example, ExampleFile, Finished, JobText, Options, Output, Pictured, Refusal,
    RefusalKind, StressSurface, StressVolume, Studio, Surface, router,
};
use http_body_util::BodyExt;
use serde_json::Value;
use tower::ServiceExt;

/// Plans meshes with the planner itself; strength is tested from the command line, whose engine does it.
pub(crate) struct Planner;

impl Engine for Planner {
    fn exit_code(&self, kind: RefusalKind) -> i32 {
        match kind {
            RefusalKind::Fault => 1,
            RefusalKind::Usage => 2,
            RefusalKind::Input => 3,
            RefusalKind::Physics => 4,
            RefusalKind::Interrupted => 130,
        }
    }

    fn job_for(&self, file: &Path) -> Result<String, Refusal> {
        if file.extension().is_some_and(|e| e == "txt") {
            return Err(Refusal::usage("no part"));
        }
        Ok(format!("# {}\n", file.file_name().expect("a file").display()))
    }

    fn check(&self, job: &JobText, _: &Roots) -> Result<(), Refusal> {
        let read = parse_job(&job.text, &job.name, &[], &|_| Err("no own profiles".to_owned()));
        read.map(drop).map_err(|e| Refusal::usage(e.to_string()))
    }

    /// What is asked for, in words.
    fn picture(&self, of: Pictured<'_>) -> Vec<u8> {
        let words = match of {
            Pictured::Part(program) => format!("part of {}", program.layers.len()),
            Pictured::Layer(_, layer) => format!("layer {layer}"),
            Pictured::Shape(surface) => format!("shape of {}", surface.triangles.len()),
            Pictured::Stress(_, case) => format!("stress of {}", case.name),
        };
        words.into_bytes()
    }

    fn examples(&self) -> Vec<Example> {
        vec![Example { name: "pair", about: "two files" }]
    }

    fn example(&self, name: &str) -> Option<Vec<ExampleFile>> {
        let files = [("first.toml", "# first\n"), ("second.toml", "# second\n")];
        (name == "pair").then(|| files.map(|(n, text)| (n.to_owned(), text.into())).to_vec())
    }

    /// A square of two triangles with one face and one open edge.
    fn shape(&self, job: &JobText, _: &Roots, _: &Diagnostics) -> Result<Finished, Refusal> {
        let surface = Surface {
            vertices: vec![[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 3.0, 0.0], [0.0, 3.0, 0.5]],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            face: vec![7, u32::MAX],
            faulty_edges: vec![[[0.0, 0.0, 0.0], [2.0, 0.0, 0.25]]],
            borders: vec![[0, 2]],
            file_faults: vec![[[2.0, 0.0, 0.0], [2.0, 3.0, 0.75]]],
        };
        let report = serde_json::json!({ "ok": true, "text": job.text, "folder": job.folder });
        Ok(Finished { report, surface: Some(surface), ..Finished::default() })
    }

    /// Two cases on one triangle.
    fn stress(&self, _: &JobText, _: &Roots, _: &Diagnostics) -> Result<Finished, Refusal> {
        let case = |name: &str, by: f32| CaseValues {
            name: name.to_owned(),
            values: (0..3).map(|k| [0, 1, 2, 3, 4, 5, 6, 7, 8].map(|c| by * (c + 10 * k) as f32)).collect(),
            inside: (0..4).map(|k| [by * k as f32; 9]).collect(),
            lines: vec![vec![[0.0, 0.0, 0.0, by], [1.0, 0.0, 0.0, 2.0 * by]], vec![[0.0, 1.0, 0.0, -by]]],
        };
        let stress = StressSurface {
            points: vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
            triangles: vec![[0, 1, 2]],
            cases: vec![case("pull", 1.0), case("bend", -0.5)],
            volume: StressVolume {
                points: vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
                tetrahedra: vec![[0, 1, 2, 3]],
            },
        };
        Ok(Finished { stress: Some(stress), ..Finished::default() })
    }

    fn orient(&self, job: &JobText, _: &Roots, _: &Diagnostics) -> Result<Finished, Refusal> {
        let report = serde_json::json!({ "ok": true, "kind": "orient", "poses": [], "text": job.text });
        Ok(Finished { report, ..Finished::default() })
    }

    fn supports(&self, _: &JobText, _: &Roots, _: &Diagnostics) -> Result<Finished, Refusal> {
        let ends = [[1.0, 2.0, 3.0, 0.25], [1.0, 2.5, 0.0, 4.0]];
        let branches = vec![Branch { ends, load_n: 0.5, is_contact: true }, Branch::default()];
        Ok(Finished { branches: Some(branches), ..Finished::default() })
    }

    fn plan(
        &self,
        job: &JobText,
        out: &Path,
        roots: &Roots,
        diagnostics: &Diagnostics,
        ready: &dyn Fn(&Arc<Program>),
    ) -> Result<Finished, Refusal> {
        let settings = parse_job(&job.text, &job.name, &[], &|_| Err("no own profiles".to_owned()))
            .map_err(|e| Refusal::usage(e.to_string()))?;
        let path = roots.readable(&job.folder.join(&settings.shape.mesh))?;
        let shown = path.display().to_string();
        let bytes = fs::read(&path).map_err(|e| Refusal::input(e.to_string()))?;
        let wrong = |e: grainpath::Error| Refusal::input(e.to_string());
        let mesh = parse_mesh(&bytes, Some(&shown))
            .map_err(|source| wrong(grainpath::Error::Mesh { path: shown.clone(), source }))?;
        let inputs = Inputs {
            mesh,
            path: shown,
            stress: None,
            deck: None,
            directions: None,
            densities: None,
            photos: vec![],
            texture: None,
            regions: Default::default(),
            known: None,
        };
        let planned = plan_job(&settings, inputs, diagnostics).map_err(wrong)?;
        let mut gcode = Vec::new();
        write_gcode(&planned.plan, &planned.config, &[], &mut gcode).map_err(|e| wrong(e.into()))?;
        let place = roots.writable(&out.join("part.gcode"))?;
        fs::write(&place, &gcode).map_err(|e| Refusal::usage(e.to_string()))?;
        let program =
            simulate(&gcode, 1.75, &Limits::default()).map_err(|e| Refusal::input(e.to_string()))?;
        let program = Arc::new(program);
        ready(&program);
        // Measuring may take long.
        while job.text.contains("# measures until it is stopped") {
            diagnostics.check().map_err(|e| Refusal::input(e.to_string()))?;
            std::thread::sleep(Duration::from_millis(2));
        }
        // A guide whose angle to the first bead of a layer is 0, to the second half a degree, and so on.
        let count = |l: &grainpath_gcode::BeadLayer| (0..l.beads.len()).map(|k| (k % 181) as u8).collect();
        let is_guided = job.text.contains("# follows a guide");
        let angles = is_guided.then(|| program.layers.iter().map(count).collect());
        // Reserves of its own: 200 for the first bead of a layer, one less for the second.
        let reserve =
            |l: &grainpath_gcode::BeadLayer| (0..l.beads.len()).map(|k| 200 - (k % 181) as u8).collect();
        let reserve =
            job.text.contains("# tells a reserve").then(|| program.layers.iter().map(reserve).collect());
        Ok(Finished {
            angles,
            reserve,
            report: serde_json::json!({ "ok": true, "mass_g": 1.5, "time_s": 60.0, "layers": program.layers.len() }),
            program,
            outputs: vec![Output { kind: "gcode".to_owned(), path: place }],
            warnings: diagnostics.warnings(),
            ..Finished::default()
        })
    }

    fn strength(
        &self,
        _: &JobText,
        _: Option<&Path>,
        _: &Roots,
        _: &Diagnostics,
    ) -> Result<Finished, Refusal> {
        Err(Refusal::usage("this engine plans only"))
    }
}

/// A box as binary STL, mm.
pub(crate) fn box_stl(size: [f32; 3]) -> Vec<u8> {
    let corner = |k: usize| [0, 1, 2].map(|a| if k >> a & 1 == 1 { size[a] } else { 0.0 });
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let mut bytes = vec![0; 80];
    bytes.extend(12_u32.to_le_bytes());
    for f in faces {
        for t in [[f[0], f[1], f[2]], [f[0], f[2], f[3]]] {
            bytes.extend([0; 12]);
            t.map(corner).iter().flatten().for_each(|v: &f32| bytes.extend(v.to_le_bytes()));
            bytes.extend([0; 2]);
        }
    }
    bytes
}

/// Two layers of a square of 20 mm.
pub(crate) const PROGRAM: &str = "; generated by Squares 1\nM83\nG1 Z0.2 F600\n;LAYER_CHANGE\nG1 X10 Y10 F6000\n;TYPE:External perimeter\nG1 X30 E0.7 F1800\n\
                           G1 Y30 E0.7\nG1 X10 E0.7\nG1 Y10 E0.7\n;LAYER_CHANGE\nG1 Z0.4\n;TYPE:Internal infill\nG1 X30 Y30 E0.9 F3000\n";

/// An answer.
pub(crate) struct Answer {
    pub status: StatusCode,
    pub headers: HeaderMap,
    pub bytes: Vec<u8>,
}

impl Answer {
    pub(crate) fn json(&self) -> Value {
        serde_json::from_slice(&self.bytes)
            .unwrap_or_else(|e| panic!("{e}: {}", String::from_utf8_lossy(&self.bytes)))
    }

    pub(crate) fn error(&self) -> String {
        self.json()["error"].as_str().expect("an error").to_owned()
    }

    pub(crate) fn header(&self, name: &str) -> &str {
        self.headers.get(name).map_or("", |v| v.to_str().expect("text"))
    }
}

/// A studio in a folder of its own: `part.stl`, `square.gcode`, `job.toml` in `files/`, and `secret/key.gcode` beside it.
pub(crate) struct Bench {
    pub dir: tempfile::TempDir,
    pub router: Router,
    pub token: String,
    runtime: tokio::runtime::Runtime,
}

impl Bench {
    pub(crate) fn new() -> Self {
        Self::with(|_| {})
    }

    pub(crate) fn with(change: impl FnOnce(&mut Options)) -> Self {
        let dir = tempfile::tempdir().expect("a folder");
        let files = dir.path().join("files");
        for folder in ["files/deep", "secret"] {
            fs::create_dir_all(dir.path().join(folder)).expect("a folder");
        }
        fs::write(files.join("part.stl"), box_stl([20.0, 10.0, 2.0])).expect("written");
        fs::write(files.join("square.gcode"), PROGRAM).expect("written");
        fs::write(files.join("job.toml"), "[shape]\nmesh = \"part.stl\"\n").expect("written");
        fs::write(files.join("notes.txt"), "nothing").expect("written");
        fs::write(files.join(".hidden"), "nothing").expect("written");
        fs::write(dir.path().join("secret/key.gcode"), PROGRAM).expect("written");
        let mut options = Options {
            work: files.join("studio"),
            roots: vec![files],
            max_upload: 1_000_000,
            ..Options::default()
        };
        change(&mut options);
        let studio = Studio::new(&options, Arc::new(Planner)).expect("a studio");
        let token = studio.access.token().to_owned();
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().expect("a runtime");
        Self { router: router(Arc::new(studio)), token, dir, runtime }
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.dir.path().join(name)
    }

    pub(crate) fn shown(&self, name: &str) -> String {
        self.path(name).display().to_string()
    }

    /// Sends a request as it is.
    pub(crate) fn raw(&self, request: Request<Body>) -> Answer {
        let answered = self.runtime.block_on(async {
            let response = self.router.clone().oneshot(request).await.expect("an answer");
            let (status, headers) = (response.status(), response.headers().clone());
            // Streams of events have an end where their job has one.
            let whole = tokio::time::timeout(Duration::from_secs(60), response.into_body().collect()).await;
            (status, headers, whole.expect("the body ends").expect("a body").to_bytes().to_vec())
        });
        Answer { status: answered.0, headers: answered.1, bytes: answered.2 }
    }

    /// A request with the token and a host that is allowed.
    pub(crate) fn request(&self, method: &str, address: &str) -> axum::http::request::Builder {
        let bearer = format!("Bearer {}", self.token);
        Request::builder()
            .method(method)
            .uri(address)
            .header("host", "127.0.0.1:4711")
            .header("authorization", bearer)
    }

    pub(crate) fn get(&self, address: &str) -> Answer {
        self.raw(self.request("GET", address).body(Body::empty()).expect("a request"))
    }

    pub(crate) fn delete(&self, address: &str) -> Answer {
        self.raw(self.request("DELETE", address).body(Body::empty()).expect("a request"))
    }

    pub(crate) fn put(&self, address: &str, body: &Value) -> Answer {
        let request = self.request("PUT", address).header("content-type", "application/json");
        self.raw(request.body(Body::from(body.to_string())).expect("a request"))
    }

    pub(crate) fn post(&self, address: &str, body: &Value) -> Answer {
        self.post_bytes(address, body.to_string().into_bytes())
    }

    pub(crate) fn post_bytes(&self, address: &str, body: Vec<u8>) -> Answer {
        let request = self.request("POST", address).header("content-type", "application/json");
        self.raw(request.body(Body::from(body)).expect("a request"))
    }

    /// Begins a job and waits for its end.
    pub(crate) fn run(&self, wanted: &Value) -> Value {
        let begun = self.post("/v1/jobs", wanted);
        assert_eq!(begun.status, StatusCode::ACCEPTED, "{}", String::from_utf8_lossy(&begun.bytes));
        self.end(begun.json()["id"].as_u64().expect("a number"))
    }

    /// Waits for the end of a job.
    pub(crate) fn end(&self, id: u64) -> Value {
        let begun = Instant::now();
        loop {
            let state = self.get(&format!("/v1/jobs/{id}")).json();
            if ["done", "failed", "cancelled"].contains(&state["phase"].as_str().expect("a phase")) {
                return state;
            }
            assert!(begun.elapsed() < Duration::from_secs(60), "{state}");
            std::thread::sleep(Duration::from_millis(2));
        }
    }

    /// The number of a job that shows the square.
    pub(crate) fn square(&self) -> u64 {
        let state =
            self.run(&serde_json::json!({ "kind": "view", "file": self.shown("files/square.gcode") }));
        assert_eq!(state["phase"], "done", "{state}");
        state["id"].as_u64().expect("a number")
    }
}
