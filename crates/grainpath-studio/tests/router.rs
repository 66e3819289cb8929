//! The HTTP interface without a port: who may ask, which files may be named, and what is answered.

mod support;

use std::fs;
use std::time::{Duration, Instant};

use axum::body::Body;
use axum::http::{Request, StatusCode};
use serde_json::json;
use support::{Bench, PROGRAM};

fn bare(address: &str, headers: &[(&str, &str)]) -> Request<Body> {
    let all =
        headers.iter().fold(Request::builder().uri(address), |r, (name, value)| r.header(*name, *value));
    all.body(Body::empty()).expect("a request")
}

const OWN: (&str, &str) = ("host", "127.0.0.1:4711");

// ---- who may ask ----

#[test]
fn without_a_token_nothing_is_answered() {
    let bench = Bench::new();
    for address in ["/", "/app.js", "/v1/state", "/v1/files?path=/", "/v1/jobs", "/v1/nothing", "/nothing"] {
        let answer = bench.raw(bare(address, &[OWN]));
        assert_eq!(answer.status, StatusCode::UNAUTHORIZED, "{address}");
        assert!(answer.error().contains("token"), "{address}");
    }
}

#[test]
fn a_wrong_token_is_no_token() {
    let bench = Bench::new();
    let cut = format!("Bearer {}", &bench.token[1..]);
    let longer = format!("Bearer {}0", bench.token);
    for given in ["Bearer 0123", "Bearer ", &cut, &longer, &bench.token] {
        let answer = bench.raw(bare("/v1/state", &[OWN, ("authorization", given)]));
        assert_eq!(answer.status, StatusCode::UNAUTHORIZED, "{given}");
    }
}

#[test]
fn the_token_in_the_address_becomes_a_cookie() {
    let bench = Bench::new();
    let opened = bench.raw(bare(&format!("/?token={}", bench.token), &[OWN]));
    assert_eq!((opened.status, opened.header("location")), (StatusCode::SEE_OTHER, "/"));
    let cookie = opened.header("set-cookie").to_owned();
    for word in ["HttpOnly", "SameSite=Strict", "Path=/"] {
        assert!(cookie.contains(word), "{cookie}");
    }
    let pair = cookie.split(';').next().expect("a pair");
    let page = bench.raw(bare("/", &[OWN, ("cookie", &format!("other=1; {pair}"))]));
    assert_eq!(page.status, StatusCode::OK);
    assert!(String::from_utf8_lossy(&page.bytes).contains("<title>grainpath studio</title>"));
}

#[test]
fn a_wrong_token_in_the_address_sets_no_cookie() {
    let bench = Bench::new();
    let answer = bench.raw(bare("/?token=0123", &[OWN]));
    assert_eq!(answer.status, StatusCode::UNAUTHORIZED);
    assert!(answer.headers.get("set-cookie").is_none());
}

#[test]
fn the_token_in_the_address_opens_the_page_alone() {
    let bench = Bench::new();
    let address = format!("/v1/state?token={}", bench.token);
    assert_eq!(bench.raw(bare(&address, &[OWN])).status, StatusCode::UNAUTHORIZED);
}

#[test]
fn the_cookie_of_another_studio_is_refused() {
    let (bench, other) = (Bench::new(), Bench::new());
    let cookie = format!("grainpath_{}={}", &bench.token[..4], other.token);
    assert_eq!(bench.raw(bare("/v1/state", &[OWN, ("cookie", &cookie)])).status, StatusCode::UNAUTHORIZED);
}

#[test]
fn foreign_hosts_are_refused_with_the_token_too() {
    let bench = Bench::new();
    let bearer = format!("Bearer {}", bench.token);
    for host in ["evil.example", "evil.example:4711", "127.0.0.1.evil.example", "192.168.0.7", ""] {
        let answer = bench.raw(bare("/v1/state", &[("host", host), ("authorization", &bearer)]));
        assert_eq!(answer.status, StatusCode::FORBIDDEN, "{host}");
    }
    let none = bench.raw(bare("/v1/state", &[("authorization", &bearer)]));
    assert_eq!(none.status, StatusCode::FORBIDDEN);
}

#[test]
fn hosts_of_this_computer_are_answered_at_any_port() {
    let bench = Bench::new();
    let bearer = format!("Bearer {}", bench.token);
    for host in ["localhost:9000", "127.0.0.1", "[::1]:8080"] {
        let answer = bench.raw(bare("/v1/state", &[("host", host), ("authorization", &bearer)]));
        assert_eq!(answer.status, StatusCode::OK, "{host}");
    }
}

#[test]
fn hosts_given_by_the_user_are_answered() {
    let bench = Bench::with(|o| o.hosts = vec!["lab.example".to_owned()]);
    let bearer = format!("Bearer {}", bench.token);
    let ask = |host| bench.raw(bare("/v1/state", &[("host", host), ("authorization", &bearer)])).status;
    assert_eq!(ask("lab.example:443"), StatusCode::OK);
    assert_eq!(ask("other.example"), StatusCode::FORBIDDEN);
}

#[test]
fn requests_of_other_pages_are_refused() {
    let bench = Bench::new();
    let bearer = format!("Bearer {}", bench.token);
    for origin in ["http://evil.example", "null", "http://127.0.0.1:1", "https://localhost:4711"] {
        let answer = bench.raw(bare("/v1/state", &[OWN, ("authorization", &bearer), ("origin", origin)]));
        assert_eq!(answer.status, StatusCode::FORBIDDEN, "{origin}");
    }
    let own = [OWN, ("authorization", bearer.as_str()), ("origin", "http://127.0.0.1:4711")];
    assert_eq!(bench.raw(bare("/v1/state", &own)).status, StatusCode::OK);
}

#[test]
fn no_answer_allows_another_origin() {
    let bench = Bench::new();
    let answer = bench.raw(bare("/v1/state", &[OWN, ("origin", "http://evil.example")]));
    assert!(answer.headers.get("access-control-allow-origin").is_none());
    let request = bench.request("OPTIONS", "/v1/jobs").header("access-control-request-method", "POST");
    let answer = bench.raw(request.body(Body::empty()).expect("a request"));
    assert!(answer.headers.get("access-control-allow-origin").is_none());
}

#[test]
fn every_answer_has_the_policy() {
    let bench = Bench::new();
    let refused = bench.raw(bare("/", &[("host", "evil.example")]));
    for answer in
        [bench.get("/"), bench.get("/app.js"), bench.get("/v1/state"), bench.get("/nothing"), refused]
    {
        let policy = answer.header("content-security-policy");
        for word in
            ["default-src 'none'", "script-src 'self'", "connect-src 'self'", "frame-ancestors 'none'"]
        {
            assert!(policy.contains(word), "{policy}");
        }
        for word in ["unsafe", "http:", "https:", "*"] {
            assert!(!policy.contains(word), "{policy}");
        }
        assert_eq!(answer.header("x-content-type-options"), "nosniff");
        assert_eq!(answer.header("referrer-policy"), "no-referrer");
    }
}

// ---- the page ----

#[test]
fn the_page_names_no_other_computer() {
    let bench = Bench::new();
    let page = String::from_utf8(bench.get("/").bytes).expect("text");
    assert!(!page.contains("http:") && !page.contains("https:") && !page.contains("//"), "{page}");
    // Relative addresses work below a path too.
    assert!(page.contains("src=\"app.js\"") && page.contains("href=\"app.css\""), "{page}");
    let style = String::from_utf8(bench.get("/app.css").bytes).expect("text");
    assert!(!style.contains("url(") && !style.contains("@import"), "no other file is named");
}

#[test]
fn the_page_has_no_inline_script_or_style() {
    let page = String::from_utf8(Bench::new().get("/").bytes).expect("text");
    assert!(!page.contains("style=") && !page.contains("<style") && !page.contains("onclick"), "{page}");
    assert_eq!(page.matches("<script").count(), 1);
}

#[test]
fn the_page_is_packed_and_known_again() {
    let bench = Bench::new();
    let plain = bench.get("/app.js");
    let request = bench.request("GET", "/app.js").header("accept-encoding", "gzip, br");
    let packed = bench.raw(request.body(Body::empty()).expect("a request"));
    assert_eq!(packed.header("content-encoding"), "gzip");
    assert!(packed.bytes.len() * 2 < plain.bytes.len());
    let mut unpacked = Vec::new();
    std::io::copy(&mut flate2::read::GzDecoder::new(&packed.bytes[..]), &mut unpacked).expect("gzip");
    assert_eq!(unpacked, plain.bytes);
    let request = bench.request("GET", "/app.js").header("if-none-match", plain.header("etag"));
    assert_eq!(bench.raw(request.body(Body::empty()).expect("a request")).status, StatusCode::NOT_MODIFIED);
}

/// Measured: 212 kB of scripts, 3.5 kB of styles.
#[test]
fn the_page_is_smaller_than_300_kb_packed() {
    let bench = Bench::new();
    let length = |address| {
        let request = bench.request("GET", address).header("accept-encoding", "gzip");
        bench.raw(request.body(Body::empty()).expect("a request")).bytes.len()
    };
    let all: usize =
        ["/", "/app.js", "/shared.js", "/worker.js", "/app.css"].iter().map(|address| length(address)).sum();
    assert!((50_000..300_000).contains(&all), "{all}");
}

#[test]
fn licences_of_the_page_are_there() {
    let text = String::from_utf8(Bench::new().get("/licences.txt").bytes).expect("text");
    assert!(text.contains("three 0.") && text.contains("The MIT License"), "{text}");
}

#[test]
fn below_a_path_everything_moves() {
    let bench = Bench::with(|o| o.base = "/tools/grainpath/".to_owned());
    assert_eq!(bench.get("/tools/grainpath/v1/state").status, StatusCode::OK);
    assert_eq!(bench.get("/tools/grainpath/app.js").status, StatusCode::OK);
    assert_eq!(bench.get("/v1/state").status, StatusCode::NOT_FOUND);
    let opened = bench.raw(bare(&format!("/tools/grainpath/?token={}", bench.token), &[OWN]));
    assert_eq!(opened.header("location"), "/tools/grainpath/");
    assert!(opened.header("set-cookie").contains("Path=/tools/grainpath/"));
}

#[test]
fn unknown_addresses_say_so() {
    let answer = Bench::new().get("/v1/nothing");
    assert_eq!(answer.status, StatusCode::NOT_FOUND);
    assert!(answer.error().contains("no such address"));
}

#[test]
fn unknown_methods_are_refused() {
    let bench = Bench::new();
    let request = bench.request("PUT", "/v1/jobs").body(Body::empty()).expect("a request");
    let answer = bench.raw(request);
    assert_eq!(answer.status, StatusCode::METHOD_NOT_ALLOWED);
    assert_eq!(answer.header("allow"), "GET,HEAD,POST");
    assert!(answer.error().contains("does not take PUT"), "{}", answer.error());
}

/// Errors of the description are JSON, also those that no handler makes.
#[test]
fn addresses_that_do_not_fit_are_answered_in_json() {
    let bench = Bench::new();
    for address in
        ["/v1/jobs/seven", "/v1/jobs/-1/result", "/v1/jobs/1/stress/x", "/v1/files", "/v1/jobs/1/none"]
    {
        let answer = bench.get(address);
        assert!(answer.status.is_client_error(), "{address}");
        assert_eq!(answer.json()["ok"], false, "{address}");
        assert!(answer.error().len() > 10, "{address}: {}", answer.error());
        assert_eq!(answer.header("content-type"), "application/json", "{address}");
    }
}

// ---- files ----

#[test]
fn the_state_names_folders_and_limits() {
    let bench = Bench::new();
    let state = bench.get("/v1/state").json();
    assert_eq!(state["max_upload_bytes"], 1_000_000);
    assert_eq!(state["opened"], serde_json::Value::Null);
    assert!(state["work"].as_str().expect("text").ends_with("files/studio"));
    assert_eq!(state["version"], env!("CARGO_PKG_VERSION"));
}

#[test]
fn the_file_of_the_command_line_is_opened_first() {
    let mut shown = String::new();
    let bench = Bench::with(|o| {
        let file = o.roots[0].join("square.gcode");
        shown = fs::canonicalize(&file).expect("there").display().to_string();
        o.file = Some(file);
    });
    let state = bench.get("/v1/state").json();
    assert_eq!(
        (state["opened"]["path"].as_str(), state["opened"]["kind"].as_str()),
        (Some(shown.as_str()), Some("program"))
    );
}

#[test]
fn folders_list_what_can_be_opened() {
    let bench = Bench::new();
    let listing = bench.get(&format!("/v1/files?path={}", bench.shown("files"))).json();
    let names = |key: &str| -> Vec<String> {
        let rows = listing[key].as_array().expect("rows");
        rows.iter().map(|r| r["name"].as_str().expect("a name").to_owned()).collect()
    };
    assert_eq!(names("folders"), ["deep", "studio"]);
    assert_eq!(names("files"), ["job.toml", "notes.txt", "part.stl", "square.gcode"]);
    let kinds: Vec<&str> = listing["files"]
        .as_array()
        .expect("rows")
        .iter()
        .map(|r| r["kind"].as_str().expect("a kind"))
        .collect();
    assert_eq!(kinds, ["job", "other", "mesh", "program"]);
    // The folder above is outside.
    assert_eq!(listing["parent"], serde_json::Value::Null);
}

#[test]
fn files_are_told_apart_by_their_endings() {
    let bench = Bench::new();
    let wanted = [
        ("a.PNG", "photo"),
        ("b.nii.gz", "scan"),
        ("c.dcm", "scan"),
        ("d.gz", "other"),
        ("e.gcode", "program"),
        ("nii.gz", "other"),
    ];
    for (name, _) in wanted {
        fs::write(bench.path("files/deep").join(name), "x").expect("a file");
    }
    let listing = bench.get(&format!("/v1/files?path={}", bench.shown("files/deep"))).json();
    let kind = |name: &str| {
        let rows = listing["files"].as_array().expect("rows");
        rows.iter().find(|r| r["name"] == name).map(|r| r["kind"].as_str().expect("a kind").to_owned())
    };
    for (name, of) in wanted {
        assert_eq!(kind(name).as_deref(), Some(of), "{name}");
    }
}

#[test]
fn a_job_is_made_of_a_file_below_the_roots_alone() {
    let bench = Bench::new();
    let made = bench.get(&format!("/v1/job?path={}", bench.shown("files/part.stl"))).json();
    assert_eq!(made["text"], "# part.stl\n");
    assert!(made["folder"].as_str().expect("a folder").ends_with("files"));
    let refused = bench.get(&format!("/v1/job?path={}", bench.shown("files/notes.txt")));
    assert_eq!(refused.error(), "no part");
    let outside = bench.get(&format!("/v1/job?path={}", bench.shown("secret/key.gcode")));
    assert!(outside.error().contains("not found below the folders"), "{}", outside.error());
}

#[test]
fn an_example_is_written_to_a_folder_of_its_own_each_time() {
    let bench = Bench::new();
    let listed = bench.get("/v1/examples").json();
    assert_eq!(listed["examples"][0]["name"], "pair");
    let write = || {
        bench.post_bytes("/v1/examples?name=pair", vec![]).json()["path"].as_str().expect("a path").to_owned()
    };
    let (first, second) = (write(), write());
    assert_ne!(first, second);
    for path in [first, second] {
        assert!(path.ends_with("first.toml"), "{path}");
        let text = bench.get(&format!("/v1/text?path={path}")).json();
        assert_eq!(text["text"], "# first\n");
        assert!(std::path::Path::new(&path).with_file_name("second.toml").is_file());
    }
    let unknown = bench.post_bytes("/v1/examples?name=..%2Fpair", vec![]);
    assert!(unknown.error().contains("there are pair"), "{}", unknown.error());
}

/// Keeps a change of a job.
fn keep(bench: &Bench, path: &str, text: &str, from: &str) -> StatusCode {
    let draft = json!({ "path": path, "kind": "job", "text": text, "from": from });
    bench.put("/v1/drafts", &draft).status
}

/// Paths and texts of the changes that are kept, the newest first.
fn kept(bench: &Bench) -> Vec<(String, String)> {
    let word = |value: &serde_json::Value| value.as_str().expect("a text").to_owned();
    let told = bench.get("/v1/drafts").json();
    let rows = told["drafts"].as_array().expect("a list");
    rows.iter().map(|row| (word(&row["path"]), word(&row["text"]))).collect()
}

fn pair(path: &str, text: &str) -> (String, String) {
    (path.to_owned(), text.to_owned())
}

#[test]
fn changes_outlive_the_studio_and_the_last_one_of_a_file_stays() {
    let bench = Bench::new();
    assert_eq!(kept(&bench), []);
    assert_eq!(keep(&bench, "/a.toml", "# one\n", ""), StatusCode::NO_CONTENT);
    assert_eq!(keep(&bench, "/b.toml", "# b\n", "# old\n"), StatusCode::NO_CONTENT);
    assert_eq!(keep(&bench, "/a.toml", "# two\n", ""), StatusCode::NO_CONTENT);
    let both = [pair("/a.toml", "# two\n"), pair("/b.toml", "# b\n")];
    assert_eq!(kept(&bench), both);
    let row = &bench.get("/v1/drafts").json()["drafts"][1];
    assert_eq!((row["from"].as_str(), row["kind"].as_str()), (Some("# old\n"), Some("job")));
    assert!(row["at_s"].as_u64() > Some(1_700_000_000), "{row}");
    // A studio that is started later in the same folder.
    let work = bench.path("files/studio");
    let later = Bench::with(|o| o.work = work.clone());
    assert_eq!(kept(&later), both);
    // A text that is that of the file again is no change.
    assert_eq!(keep(&later, "/a.toml", "", ""), StatusCode::NO_CONTENT);
    assert_eq!(kept(&bench), both[1..]);
    // No temporary file is left beside the one that was renamed and the one that is locked.
    let names = fs::read_dir(&work).expect("the folder").flatten();
    let mut names: Vec<_> = names.map(|n| n.file_name()).collect();
    names.sort();
    assert_eq!(names, [".drafts.lock", "drafts.json"]);
}

#[test]
fn a_change_that_a_later_one_of_its_page_has_overtaken_is_left_out() {
    let bench = Bench::new();
    let put = |page: &str, change: u64, text: &str| {
        let draft = json!({ "path": "/a.toml", "kind": "job", "text": text, "from": "", "page": page, "change": change });
        assert_eq!(bench.put("/v1/drafts", &draft).status, StatusCode::NO_CONTENT);
        kept(&bench)[0].1.clone()
    };
    assert_eq!(put("one", 7, "# seven"), "# seven");
    assert_eq!(put("one", 6, "# six"), "# seven");
    // Pages do not know each other's numbers: the last one stays.
    assert_eq!(put("two", 0, "# two"), "# two");
    assert_eq!(put("one", 8, "# eight"), "# eight");
    assert_eq!(put("", 0, "# none"), "# none");
}

#[test]
fn twenty_changes_and_32_mib_of_them_are_kept() {
    let bench = Bench::new();
    for k in 0..25 {
        assert_eq!(keep(&bench, &format!("/{k}.toml"), "# new\n", ""), StatusCode::NO_CONTENT);
    }
    let names: Vec<String> = kept(&bench).into_iter().map(|(path, _)| path).collect();
    assert_eq!(names, (5..25).rev().map(|k| format!("/{k}.toml")).collect::<Vec<_>>());
    let large = "#".repeat(7 << 20);
    for k in 0..6 {
        assert_eq!(keep(&bench, &format!("/large-{k}.toml"), &large, ""), StatusCode::NO_CONTENT);
    }
    let names: Vec<String> = kept(&bench).into_iter().map(|(path, _)| path).collect();
    assert_eq!(names, (2..6).rev().map(|k| format!("/large-{k}.toml")).collect::<Vec<_>>());
    let status = keep(&bench, "/larger.toml", &"#".repeat(9 << 20), "");
    assert_eq!(status, StatusCode::PAYLOAD_TOO_LARGE);
}

#[test]
fn a_damaged_file_of_changes_is_named_and_left() {
    let bench = Bench::new();
    let file = bench.path("files/studio/drafts.json");
    fs::write(&file, "[{").expect("written");
    let told = bench.get("/v1/drafts");
    assert_eq!(told.status, StatusCode::UNPROCESSABLE_ENTITY);
    assert!(
        told.error().contains("drafts.json") && told.error().contains("move it away"),
        "{}",
        told.error()
    );
    assert_eq!(keep(&bench, "/a.toml", "# one\n", ""), StatusCode::UNPROCESSABLE_ENTITY);
    assert_eq!(fs::read_to_string(&file).expect("it is there"), "[{");
    let other = bench.put("/v1/drafts", &json!({ "path": "/a.toml", "text": "" }));
    assert_eq!(other.status, StatusCode::UNPROCESSABLE_ENTITY);
}

/// Several pages of two studios in one folder write at once: the file has each of their changes, whole.
#[test]
fn changes_of_many_pages_and_of_two_studios_at_once_are_all_kept() {
    let bench = Bench::new();
    let studio = bench.path("files/studio");
    let other = Bench::with(|o| o.work = studio.clone());
    let runtime = tokio::runtime::Builder::new_multi_thread().worker_threads(4).enable_all().build();
    runtime.expect("threads").block_on(async {
        let all = (0..16).map(|k| {
            let draft = json!({ "path": format!("/{k}.toml"), "kind": "job", "text": "# new\n", "from": "" });
            let bench = if k % 2 == 0 { &bench } else { &other };
            let request = bench.request("PUT", "/v1/drafts").header("content-type", "application/json");
            let request = request.body(Body::from(draft.to_string())).expect("a request");
            tokio::spawn(tower::ServiceExt::oneshot(bench.router.clone(), request))
        });
        for answer in all.collect::<Vec<_>>() {
            assert_eq!(answer.await.expect("no panic").expect("an answer").status(), StatusCode::NO_CONTENT);
        }
    });
    assert_eq!(kept(&bench).len(), 16);
    assert!(studio.join("drafts.json").is_file());
}

#[test]
fn a_job_is_saved_under_a_new_name_below_the_working_folder_alone() {
    let bench = Bench::new();
    let save =
        |name: &str, text: &str| bench.post_bytes(&format!("/v1/text?path={name}"), text.as_bytes().to_vec());
    let saved = save("beam.toml", "# one\n");
    assert_eq!(saved.status, StatusCode::CREATED);
    let path = saved.json()["path"].as_str().expect("a path").to_owned();
    assert_eq!(
        fs::canonicalize(&path).expect("written"),
        bench.path("files/studio/beam.toml").canonicalize().expect("there")
    );
    assert_eq!(bench.get(&format!("/v1/text?path={path}")).json()["text"], "# one\n");
    // A name that is taken keeps its file, by the relative name and by the whole one.
    for name in ["beam.toml", path.as_str()] {
        let taken = save(name, "# two\n");
        assert_eq!(taken.status, StatusCode::CONFLICT, "{name}");
        assert!(taken.error().contains("is there already; choose another name"), "{}", taken.error());
    }
    assert_eq!(fs::read_to_string(&path).expect("there"), "# one\n");
    // Folders below are made; what is no job, or lies elsewhere, is refused.
    assert_eq!(save("set/beam.toml", "# three\n").status, StatusCode::CREATED);
    let input = fs::read_to_string(bench.path("files/job.toml")).expect("an input");
    for name in [
        "beam.gcode",
        "beam",
        "../job.toml",
        "../new.toml",
        "set/../../new.toml",
        &bench.shown("files/job.toml"),
        &bench.shown("secret/new.toml"),
    ] {
        assert_eq!(save(name, "# four\n").status, StatusCode::UNPROCESSABLE_ENTITY, "{name}");
    }
    assert_eq!(fs::read_to_string(bench.path("files/job.toml")).expect("an input"), input);
    assert!(!bench.path("files/new.toml").exists() && !bench.path("secret/new.toml").exists());
    // What is too large or no text leaves nothing behind.
    assert_eq!(save("large.toml", &"#".repeat((4 << 20) + 1)).status, StatusCode::PAYLOAD_TOO_LARGE);
    assert_eq!(bench.post_bytes("/v1/text?path=raw.toml", vec![0xff, 0xfe]).status, StatusCode::BAD_REQUEST);
    let left: Vec<_> =
        fs::read_dir(bench.path("files/studio")).expect("there").flatten().map(|f| f.file_name()).collect();
    assert_eq!(left.len(), 2, "{left:?}");
}

#[test]
fn folders_below_have_a_way_up() {
    let bench = Bench::new();
    let listing = bench.get(&format!("/v1/files?path={}", bench.shown("files/deep"))).json();
    assert!(listing["parent"].as_str().expect("a path").ends_with("files"));
}

#[test]
fn folders_outside_are_not_listed() {
    let bench = Bench::new();
    let outside = ["secret", "files/../secret", "files/deep/../../secret", "", "nothing"];
    for name in outside {
        let answer = bench.get(&format!("/v1/files?path={}", bench.shown(name)));
        assert_eq!(answer.status, StatusCode::UNPROCESSABLE_ENTITY, "{name}");
        assert!(answer.error().contains("not found below the folders"), "{name}");
    }
    for path in ["/", "/etc", "..", "%2e%2e%2f", "/proc/self", "~"] {
        assert_eq!(
            bench.get(&format!("/v1/files?path={path}")).status,
            StatusCode::UNPROCESSABLE_ENTITY,
            "{path}"
        );
    }
}

#[test]
fn what_is_there_and_what_is_not_look_alike_outside() {
    let bench = Bench::new();
    let error = |name: &str| {
        let shown = bench.shown(name);
        bench.get(&format!("/v1/files?path={shown}")).error().replace(&shown, "X")
    };
    assert_eq!(error("secret"), error("nothing"));
}

#[cfg(unix)]
#[test]
fn links_out_of_the_folders_are_neither_listed_nor_read() {
    let bench = Bench::new();
    std::os::unix::fs::symlink(bench.path("secret"), bench.path("files/link")).expect("a link");
    std::os::unix::fs::symlink(bench.path("secret/key.gcode"), bench.path("files/key.gcode"))
        .expect("a link");
    let listing = bench.get(&format!("/v1/files?path={}", bench.shown("files"))).json().to_string();
    assert!(!listing.contains("link") && !listing.contains("key.gcode"), "{listing}");
    for name in ["files/link/key.gcode", "files/key.gcode"] {
        let answer = bench.post("/v1/jobs", &json!({ "kind": "view", "file": bench.shown(name) }));
        assert_eq!(answer.status, StatusCode::UNPROCESSABLE_ENTITY, "{name}");
    }
}

#[test]
fn a_folder_given_by_root_is_read() {
    let bench = Bench::with(|o| {
        let other = o.roots[0].parent().expect("a folder").join("secret");
        o.roots.push(other);
    });
    let state = bench.run(&json!({ "kind": "view", "file": bench.shown("secret/key.gcode") }));
    assert_eq!(state["phase"], "done");
}

#[test]
fn a_query_without_a_path_is_refused() {
    let answer = Bench::new().get("/v1/files");
    assert_eq!(answer.status, StatusCode::BAD_REQUEST);
    assert!(answer.error().contains("path"));
}

#[test]
fn the_text_of_a_job_is_shown() {
    let bench = Bench::new();
    let text = bench.get(&format!("/v1/text?path={}", bench.shown("files/job.toml"))).json();
    assert_eq!(text["text"], "[shape]\nmesh = \"part.stl\"\n");
}

#[test]
fn texts_of_other_files_are_not_shown() {
    let bench = Bench::new();
    fs::write(bench.path("secret/other.toml"), "key = 1").expect("written");
    fs::write(bench.path("files/bytes.toml"), [0xff, 0xfe, 0x00]).expect("written");
    for name in
        ["files/notes.txt", "files/square.gcode", "secret/other.toml", "files/bytes.toml", "files/none.toml"]
    {
        let answer = bench.get(&format!("/v1/text?path={}", bench.shown(name)));
        assert_eq!(answer.status, StatusCode::UNPROCESSABLE_ENTITY, "{name}");
        assert!(!String::from_utf8_lossy(&answer.bytes).contains("key = 1"));
    }
}

#[test]
fn photographs_are_shown_and_other_files_are_not() {
    let bench = Bench::new();
    for (name, kind) in [("board.png", "image/png"), ("board.JPG", "image/jpeg"), ("board.bmp", "image/bmp")]
    {
        fs::write(bench.path(&format!("files/{name}")), b"pixels").expect("written");
        let answer = bench.get(&format!("/v1/picture?path={}", bench.shown(&format!("files/{name}"))));
        assert_eq!(
            (answer.status, answer.bytes.as_slice()),
            (StatusCode::OK, b"pixels".as_slice()),
            "{name}"
        );
        assert_eq!(answer.headers["content-type"], kind);
    }
    fs::write(bench.path("secret/board.png"), b"pixels").expect("written");
    fs::create_dir(bench.path("files/folder.png")).expect("made");
    for name in
        ["files/notes.txt", "files/job.toml", "files/folder.png", "secret/board.png", "files/none.png"]
    {
        let answer = bench.get(&format!("/v1/picture?path={}", bench.shown(name)));
        assert_eq!(answer.status, StatusCode::UNPROCESSABLE_ENTITY, "{name}");
    }
}

// ---- uploads ----

#[test]
fn a_second_file_of_a_name_keeps_its_whole_ending() {
    let bench = Bench::new();
    for name in ["vol.nii.gz", "vol-2.nii.gz", "vol-3.nii.gz"] {
        let path = send(&bench, "vol.nii.gz", vec![0]).json()["path"].as_str().expect("a path").to_owned();
        assert!(path.ends_with(&format!("uploads/{name}")), "{path}");
    }
}

fn send(bench: &Bench, name: &str, bytes: Vec<u8>) -> support::Answer {
    let request = bench.request("POST", &format!("/v1/uploads?name={name}")).body(Body::from(bytes));
    bench.raw(request.expect("a request"))
}

#[test]
fn a_dropped_file_is_written_below_the_working_folder() {
    let bench = Bench::new();
    let answer = send(&bench, "square.gcode", PROGRAM.as_bytes().to_vec());
    assert_eq!(answer.status, StatusCode::OK);
    let path = answer.json()["path"].as_str().expect("a path").to_owned();
    assert!(path.ends_with("files/studio/uploads/square.gcode"), "{path}");
    assert_eq!(fs::read_to_string(&path).expect("there"), PROGRAM);
    let state = bench.run(&json!({ "kind": "view", "file": path }));
    assert_eq!(state["phase"], "done");
}

#[test]
fn dropped_files_never_replace_each_other() {
    let bench = Bench::new();
    let path = |bytes: &[u8]| {
        send(&bench, "a.gcode", bytes.to_vec()).json()["path"].as_str().expect("a path").to_owned()
    };
    let (first, second) = (path(b"one"), path(b"two"));
    assert!(second.ends_with("a-2.gcode"), "{second}");
    assert_eq!(fs::read(first).expect("there"), b"one");
}

#[test]
fn a_dropped_file_with_a_long_name_is_still_of_its_kind() {
    let bench = Bench::new();
    let answer = send(&bench, &format!("{}.gcode", "b".repeat(240)), PROGRAM.as_bytes().to_vec());
    let path = answer.json()["path"].as_str().expect("a path").to_owned();
    assert!(path.ends_with("bbb.gcode"), "{path}");
    assert_eq!(bench.run(&json!({ "kind": "view", "file": path }))["phase"], "done");
}

#[test]
fn names_of_dropped_files_lead_nowhere_else() {
    let bench = Bench::new();
    for name in ["..%2F..%2Fout.gcode", "%2Fetc%2Fpasswd", "..", "C%3A%5Cout.gcode", ".%2F.hidden"] {
        let path = send(&bench, name, b"G1".to_vec()).json()["path"].as_str().expect("a path").to_owned();
        assert!(path.contains("files/studio/uploads/"), "{name}: {path}");
        assert!(!path.contains(".."), "{name}: {path}");
    }
    assert!(!bench.path("out.gcode").exists() && !bench.path("files/out.gcode").exists());
}

#[test]
fn a_body_over_the_limit_leaves_nothing() {
    let bench = Bench::with(|o| o.max_upload = 1000);
    let announced = send(&bench, "a.gcode", vec![b'G'; 1001]);
    assert_eq!(announced.status, StatusCode::PAYLOAD_TOO_LARGE);
    assert!(announced.error().contains("larger than 1000 bytes; "), "{}", announced.error());
    assert!(announced.error().contains("--max-upload"));
    // A stream states no length.
    let chunks = (0..20).map(|_| Ok::<_, std::io::Error>(vec![b'G'; 100]));
    let body = Body::from_stream(futures_util::stream::iter(chunks));
    let request = bench.request("POST", "/v1/uploads?name=a.gcode").body(body).expect("a request");
    assert_eq!(bench.raw(request).status, StatusCode::PAYLOAD_TOO_LARGE);
    let left = fs::read_dir(bench.path("files/studio/uploads")).map_or(0, Iterator::count);
    assert_eq!(left, 0);
    assert_eq!(send(&bench, "a.gcode", vec![b'G'; 1000]).status, StatusCode::OK);
}

#[test]
fn an_upload_that_breaks_off_leaves_nothing() {
    let bench = Bench::new();
    let chunks = [Ok(vec![b'G'; 100]), Err(std::io::Error::other("gone"))];
    let body = Body::from_stream(futures_util::stream::iter(chunks));
    let request = bench.request("POST", "/v1/uploads?name=a.gcode").body(body).expect("a request");
    assert_eq!(bench.raw(request).status, StatusCode::BAD_REQUEST);
    assert_eq!(fs::read_dir(bench.path("files/studio/uploads")).expect("made").count(), 0);
}

#[test]
fn an_empty_upload_is_refused() {
    let answer = send(&Bench::new(), "a.gcode", Vec::new());
    assert_eq!(
        (answer.status, answer.error().as_str()),
        (StatusCode::UNPROCESSABLE_ENTITY, "the file is empty")
    );
}

// ---- jobs ----

#[test]
fn a_program_is_read_and_measured() {
    let bench = Bench::new();
    let id = bench.square();
    let result = bench.get(&format!("/v1/jobs/{id}/result")).json();
    assert_eq!(result["report"]["layers"], 2);
    assert_eq!(result["report"]["generator"], "Squares 1");
    assert!(
        (result["report"]["printed_mm"].as_f64().expect("a number") - 80.0 - 800.0_f64.sqrt()).abs() < 1e-3
    );
}

#[test]
fn every_error_of_a_program_is_the_sentence_of_the_command_line() {
    let bench = Bench::new();
    for (name, bytes, words) in [
        ("empty.gcode", &b""[..], "the file is empty"),
        ("packed.bgcode", b"GCDE\x01\x00\x00\x00", "binary G-code is not read; have it written as text"),
        ("text.gcode", b"Dear Sir or Madam,\n", "not G-code: no line of 1 has a command"),
    ] {
        fs::write(bench.path(&format!("files/{name}")), bytes).expect("written");
        let state = bench.run(&json!({ "kind": "view", "file": bench.shown(&format!("files/{name}")) }));
        assert_eq!((state["phase"].as_str(), state["code"].as_i64()), (Some("failed"), Some(3)), "{state}");
        assert!(state["error"].as_str().expect("a sentence").ends_with(words), "{state}");
    }
}

#[test]
fn a_folder_is_no_program() {
    let bench = Bench::new();
    let state = bench.run(&json!({ "kind": "view", "file": bench.shown("files/deep") }));
    assert!(state["error"].as_str().expect("a sentence").contains("is a folder"), "{state}");
}

#[test]
fn programs_outside_are_not_read() {
    let bench = Bench::new();
    for name in ["secret/key.gcode", "files/../secret/key.gcode"] {
        let answer = bench.post("/v1/jobs", &json!({ "kind": "view", "file": bench.shown(name) }));
        assert_eq!(answer.status, StatusCode::UNPROCESSABLE_ENTITY, "{name}");
    }
}

#[test]
fn a_program_that_prints_nothing_has_no_layers() {
    let bench = Bench::new();
    fs::write(bench.path("files/idle.gcode"), "G28\nM104 S0\n").expect("written");
    let state = bench.run(&json!({ "kind": "view", "file": bench.shown("files/idle.gcode") }));
    assert_eq!(state["phase"], "done");
    let index = bench.get(&format!("/v1/jobs/{}/layers", state["id"])).json();
    assert_eq!(index["layers"], json!([]));
    let answer = bench.get(&format!("/v1/jobs/{}/layers/0-0", state["id"]));
    assert_eq!(answer.status, StatusCode::BAD_REQUEST);
}

#[test]
fn a_job_file_is_planned_as_it_is() {
    let bench = Bench::new();
    let state = bench.run(&json!({ "kind": "plan", "file": bench.shown("files/job.toml") }));
    assert_eq!(state["phase"], "done", "{state}");
    let result = bench.get(&format!("/v1/jobs/{}/result", state["id"])).json();
    let path = result["outputs"][0]["path"].as_str().expect("a path");
    assert!(path.ends_with("files/studio/job/part.gcode"), "{path}");
    let index = bench.get(&format!("/v1/jobs/{}/layers", state["id"])).json();
    assert_eq!(index["layers"].as_array().expect("layers").len(), 10);
}

#[test]
fn a_job_file_that_has_changed_since_it_was_opened_is_refused() {
    let bench = Bench::new();
    let (path, file) = (bench.path("files/job.toml"), bench.shown("files/job.toml"));
    let opened = fs::read_to_string(&path).expect("a job");
    let begin = |kind: &str, shown: &str| {
        bench.post("/v1/jobs", &json!({ "kind": kind, "file": file, "shown": shown }))
    };
    // A page shows neither a mark of the byte order nor CR.
    fs::write(&path, format!("\u{feff}{}", opened.replace('\n', "\r\n"))).expect("written");
    assert_eq!(begin("shape", &opened).status, StatusCode::ACCEPTED);
    fs::write(&path, format!("{opened}\n# by another program\n")).expect("written");
    for kind in ["plan", "shape", "stress", "orient", "supports", "strength"] {
        let answer = begin(kind, &opened);
        assert!(answer.error().contains("has changed on the disk since it was opened"), "{kind}");
    }
    assert!(!bench.path("files/studio/job").exists(), "nothing was begun");
}

#[test]
fn an_edited_job_is_saved_before_it_runs() {
    let bench = Bench::new();
    let text = format!("[shape]\nmesh = {:?}\n# kept\n[process]\nwalls = 3\n", bench.shown("files/part.stl"));
    let state = bench.run(&json!({ "kind": "plan", "text": text, "name": "bracket" }));
    assert_eq!(state["phase"], "done", "{state}");
    let saved = fs::read_to_string(bench.path("files/studio/bracket/job.toml")).expect("saved");
    assert_eq!(saved, text);
}

#[test]
fn runs_of_one_name_have_folders_of_their_own() {
    let bench = Bench::new();
    for folder in ["job", "job-2", "job-3"] {
        bench.run(&json!({ "kind": "plan", "file": bench.shown("files/job.toml") }));
        assert!(bench.path(&format!("files/studio/{folder}/part.gcode")).exists(), "{folder}");
    }
}

#[test]
fn errors_of_a_job_name_the_line() {
    let bench = Bench::new();
    let state = bench.run(&json!({ "kind": "plan", "text": "[process]\nwals = 3\n" }));
    let error = state["error"].as_str().expect("a sentence");
    assert!(error.ends_with("job.toml:2: unknown key `wals` in [process]; did you mean `walls`?"), "{error}");
    assert_eq!(state["code"], 2);
}

#[test]
fn shapes_outside_are_not_read() {
    let bench = Bench::new();
    fs::write(bench.path("secret/part.stl"), support::box_stl([5.0, 5.0, 1.0])).expect("written");
    for mesh in [bench.shown("secret/part.stl"), "../../../secret/part.stl".to_owned()] {
        let state = bench.run(&json!({ "kind": "plan", "text": format!("[shape]\nmesh = {mesh:?}\n") }));
        assert_eq!(state["phase"], "failed");
        assert!(
            state["error"].as_str().expect("a sentence").contains("not found below the folders"),
            "{state}"
        );
    }
}

#[test]
fn a_damaged_mesh_is_refused_with_its_sentence() {
    let bench = Bench::new();
    fs::write(bench.path("files/bad.stl"), "solid a\nfacet normal 0 0 1\nouter loop\nvertex a b c\n")
        .expect("written");
    let text = format!("[shape]\nmesh = {:?}\n", bench.shown("files/bad.stl"));
    let state = bench.run(&json!({ "kind": "plan", "text": text }));
    assert_eq!((state["phase"].as_str(), state["code"].as_i64()), (Some("failed"), Some(3)));
    assert!(state["error"].as_str().expect("a sentence").contains("bad.stl"), "{state}");
}

/// A 3MF of a few kilobytes that unpacks to a gigabyte of spaces.
#[test]
fn a_packed_bomb_is_refused_and_not_unpacked() {
    use std::io::Write;
    let bench = Bench::new();
    let mut zip = zip::ZipWriter::new(fs::File::create(bench.path("files/bomb.3mf")).expect("made"));
    let options = zip::write::SimpleFileOptions::default();
    zip.start_file("3D/3dmodel.model", options).expect("begun");
    zip.write_all(b"<model unit=\"millimeter\"><resources>").expect("written");
    let spaces = vec![b' '; 1 << 20];
    for _ in 0..1024 {
        zip.write_all(&spaces).expect("written");
    }
    zip.finish().expect("ended");
    let packed = fs::metadata(bench.path("files/bomb.3mf")).expect("there").len();
    assert!(packed < 4_000_000, "{packed}");
    let text = format!("[shape]\nmesh = {:?}\n", bench.shown("files/bomb.3mf"));
    let state = bench.run(&json!({ "kind": "plan", "text": text }));
    assert_eq!((state["phase"].as_str(), state["code"].as_i64()), (Some("failed"), Some(3)), "{state}");
}

#[test]
fn a_job_is_a_file_or_a_text() {
    let bench = Bench::new();
    for wanted in [
        json!({ "kind": "plan" }),
        json!({ "kind": "plan", "text": "", "file": bench.shown("files/job.toml") }),
    ] {
        let answer = bench.post("/v1/jobs", &wanted);
        assert!(answer.error().contains("either \"file\" or \"text\""), "{wanted}");
    }
}

#[test]
fn malformed_requests_say_what_is_wrong() {
    let bench = Bench::new();
    for body in [
        "",
        "{",
        "[]",
        "{\"kind\": \"fly\"}",
        "{\"kind\": \"view\"}",
        "{\"kind\": \"view\", \"file\": 3}",
        "{\"kind\": \"plan\", \"txt\": \"\"}",
    ] {
        let answer = bench.post_bytes("/v1/jobs", body.as_bytes().to_vec());
        assert!(answer.status.is_client_error(), "{body}");
        assert!(!answer.error().is_empty(), "{body}");
    }
    let request = bench.request("POST", "/v1/jobs").header("content-type", "text/plain");
    let answer = bench.raw(request.body(Body::from("{}")).expect("a request"));
    assert_eq!(answer.status, StatusCode::UNSUPPORTED_MEDIA_TYPE);
}

#[test]
fn a_request_of_many_megabytes_is_refused() {
    let bench = Bench::new();
    // A text in quotes and ends of lines has twice as many characters as JSON.
    for (text, limit) in [("#".repeat((4 << 20) + 1), "4.2 MB"), ("\"\n".repeat(3 << 20), "4.2 MB")] {
        let answer = bench.post("/v1/jobs", &json!({ "kind": "plan", "text": text }));
        assert_eq!(answer.status, StatusCode::PAYLOAD_TOO_LARGE);
        assert!(answer.error().contains(limit), "{}", answer.error());
    }
    let text = format!("[shape]\nmesh = \"none.stl\"\n{}", "# \"\"\n".repeat(800_000));
    let state = bench.run(&json!({ "kind": "plan", "text": text }));
    assert!(state["error"].as_str().expect("an error").contains("none.stl"), "it was read: {state}");
}

#[test]
fn a_text_is_checked_without_a_run() {
    let bench = Bench::new();
    let check = |text: &str| {
        let request = bench.request("POST", "/v1/check").body(Body::from(text.to_owned()));
        bench.raw(request.expect("a request"))
    };
    assert_eq!(check("[process]\nwalls = 3\n").json(), json!({ "ok": true, "error": null }));
    for (text, words) in [("[process\nwalls = 3\n", "job.toml:1"), ("[process]\nwals = 3\n", "wals")] {
        let answer = check(text);
        // The check succeeded, so that no browser counts a failed request.
        assert_eq!(answer.status, StatusCode::OK, "{text}");
        let told = answer.json();
        assert_eq!(told["ok"], json!(false));
        assert!(told["error"].as_str().is_some_and(|error| error.contains(words)), "{told}");
    }
    assert_eq!(bench.get("/v1/jobs").json()["jobs"], json!([]), "nothing ran");
}

#[test]
fn unknown_jobs_say_so() {
    let bench = Bench::new();
    for address in [
        "/v1/jobs/7",
        "/v1/jobs/7/result",
        "/v1/jobs/7/layers",
        "/v1/jobs/7/layers/0-0",
        "/v1/jobs/7/events",
        "/v1/jobs/7/damage",
        "/v1/jobs/7/outputs/gcode",
    ] {
        let answer = bench.get(address);
        assert_eq!(answer.status, StatusCode::NOT_FOUND, "{address}");
        assert!(answer.error().contains("no such job"), "{address}");
    }
    assert_eq!(bench.delete("/v1/jobs/7").status, StatusCode::NOT_FOUND);
    assert!(bench.get("/v1/jobs/seven").status.is_client_error());
}

#[test]
fn a_failed_job_gives_its_reason_instead_of_a_result() {
    let bench = Bench::new();
    let state = bench.run(&json!({ "kind": "plan", "text": "[process]\nwals = 3\n" }));
    for what in ["result", "layers", "layers/0-0", "damage", "outputs/gcode"] {
        let answer = bench.get(&format!("/v1/jobs/{}/{what}", state["id"]));
        assert_eq!(answer.status, StatusCode::CONFLICT, "{what}");
        assert!(answer.error().contains("wals"), "{what}");
    }
}

#[test]
fn jobs_are_listed_in_order() {
    let bench = Bench::new();
    let first = bench.square();
    let second = bench.square();
    let list = bench.get("/v1/jobs").json();
    let ids: Vec<u64> =
        list["jobs"].as_array().expect("jobs").iter().map(|j| j["id"].as_u64().expect("a number")).collect();
    assert_eq!(ids, [first, second]);
    assert_eq!(list["jobs"][0]["title"], "square.gcode");
}

/// A part that takes seconds to plan.
fn slow(bench: &Bench) -> serde_json::Value {
    fs::write(bench.path("files/large.stl"), support::box_stl([200.0, 200.0, 180.0])).expect("written");
    let text = format!(
        "[shape]\nmesh = {:?}\n[process]\nlayer_height_mm = 0.05\nfirst_layer_height_mm = 0.2\n[fill]\npattern = \"gyroid\"\n",
        bench.shown("files/large.stl")
    );
    json!({ "kind": "plan", "text": text })
}

#[test]
fn a_running_job_is_cancelled_and_writes_nothing() {
    let bench = Bench::new();
    let id = bench.post("/v1/jobs", &slow(&bench)).json()["id"].as_u64().expect("a number");
    let waiting = bench.post("/v1/jobs", &json!({ "kind": "stress", "text": "" })).json();
    assert_eq!(waiting["phase"], "waiting");
    loop {
        let state = bench.get(&format!("/v1/jobs/{id}")).json();
        assert_ne!(state["phase"], "done", "the part is too small for this test");
        if state["stage"] == "fill" {
            break;
        }
    }
    assert_eq!(bench.delete(&format!("/v1/jobs/{id}")).status, StatusCode::NO_CONTENT);
    let state = bench.end(id);
    assert_eq!((state["phase"].as_str(), state["code"].as_i64()), (Some("cancelled"), Some(130)), "{state}");
    assert!(!bench.path("files/studio/job/part.gcode").exists());
    // The next one goes on.
    assert_eq!(bench.end(waiting["id"].as_u64().expect("a number"))["phase"], "done");
}

/// The paths of a plan are shown while it is still measured, and not once it was cancelled.
#[test]
fn layers_are_sent_before_the_job_is_done() {
    let bench = Bench::new();
    let text =
        format!("# measures until it is stopped\n[shape]\nmesh = {:?}\n", bench.shown("files/small.stl"));
    fs::write(bench.path("files/small.stl"), support::box_stl([10.0, 10.0, 2.0])).expect("written");
    let id =
        bench.post("/v1/jobs", &json!({ "kind": "plan", "text": text })).json()["id"].as_u64().expect("one");
    let begun = Instant::now();
    let state = loop {
        let state = bench.get(&format!("/v1/jobs/{id}")).json();
        let layers = bench.get(&format!("/v1/jobs/{id}/layers"));
        // The first layers come before the whole.
        if layers.status == StatusCode::OK && layers.json()["more"] == false {
            break bench.get(&format!("/v1/jobs/{id}")).json();
        }
        assert!(state["layers"] == true || state["ready"] == 0, "{state}");
        assert!(begun.elapsed() < Duration::from_secs(60), "{state}");
        std::thread::sleep(Duration::from_millis(5));
    };
    assert_eq!(state["phase"], "running");
    let index = bench.get(&format!("/v1/jobs/{id}/layers")).json();
    assert!(index["layers"].as_array().is_some_and(|l| l.len() > 2), "{index}");
    let records = index["layers"][0]["records"].as_u64().expect("a number");
    assert_eq!(bench.get(&format!("/v1/jobs/{id}/layers/0-0")).bytes.len() as u64, 8 * records);
    assert_eq!(bench.get(&format!("/v1/jobs/{id}/result")).status, StatusCode::CONFLICT);
    let request = bench.request("DELETE", &format!("/v1/jobs/{id}")).body(Body::empty()).expect("a request");
    assert_eq!(bench.raw(request).status, StatusCode::NO_CONTENT);
    while bench.get(&format!("/v1/jobs/{id}")).json()["phase"] == "running" {
        std::thread::sleep(Duration::from_millis(2));
    }
    assert_eq!(bench.get(&format!("/v1/jobs/{id}/layers")).status, StatusCode::CONFLICT);
}

/// The first layers of a plan are there while the others are planned, with the bytes that they have in the whole.
#[test]
fn the_first_layer_is_sent_before_the_last_one_is_planned() {
    let bench = Bench::new();
    fs::write(bench.path("files/high.stl"), support::box_stl([60.0, 60.0, 30.0])).expect("written");
    let text = format!(
        "[shape]\nmesh = {:?}\n[process]\nlayer_height_mm = 0.1\n[fill]\npattern = \"gyroid\"\n",
        bench.shown("files/high.stl")
    );
    let id =
        bench.post("/v1/jobs", &json!({ "kind": "plan", "text": text })).json()["id"].as_u64().expect("one");
    let begun = Instant::now();
    while bench.get(&format!("/v1/jobs/{id}")).json()["ready"] == 0 {
        assert!(begun.elapsed() < Duration::from_secs(60));
        std::thread::sleep(Duration::from_millis(1));
    }
    let early = bench.get(&format!("/v1/jobs/{id}/layers")).json();
    let first = bench.get(&format!("/v1/jobs/{id}/layers/0-0"));
    let state = bench.get(&format!("/v1/jobs/{id}")).json();
    assert_eq!(
        (state["phase"].as_str(), state["stage"].as_str()),
        (Some("running"), Some("fill")),
        "{state}"
    );
    assert_eq!(first.status, StatusCode::OK);
    let state = bench.end(id);
    assert_eq!(state["phase"], "done", "{state}");
    let whole = bench.get(&format!("/v1/jobs/{id}/layers")).json();
    for key in ["origin_mm", "step_mm", "classes"] {
        assert_eq!(early[key], whole[key], "{key}");
    }
    assert_eq!((&early["more"], &whole["more"]), (&json!(true), &json!(false)));
    let n_early = early["layers"].as_array().expect("layers").len();
    let n = whole["layers"].as_array().expect("layers").len();
    assert!(n_early > 0 && n_early < n && n > 290, "{n_early} of {n}");
    assert_eq!(state["ready"], n);
    assert!(first.bytes.len() > 100 && first.bytes == bench.get(&format!("/v1/jobs/{id}/layers/0-0")).bytes);
}

#[test]
fn a_waiting_job_is_cancelled_at_once() {
    let bench = Bench::new();
    let id = bench.post("/v1/jobs", &slow(&bench)).json()["id"].as_u64().expect("a number");
    let waiting = bench.post("/v1/jobs", &slow(&bench)).json()["id"].as_u64().expect("a number");
    bench.delete(&format!("/v1/jobs/{waiting}"));
    assert_eq!(bench.get(&format!("/v1/jobs/{waiting}")).json()["phase"], "cancelled");
    bench.delete(&format!("/v1/jobs/{id}"));
    assert_eq!(bench.end(id)["phase"], "cancelled");
}

#[test]
fn cancelling_what_is_over_changes_nothing() {
    let bench = Bench::new();
    let id = bench.square();
    assert_eq!(bench.delete(&format!("/v1/jobs/{id}")).status, StatusCode::NO_CONTENT);
    assert_eq!(bench.get(&format!("/v1/jobs/{id}")).json()["phase"], "done");
    assert_eq!(bench.get(&format!("/v1/jobs/{id}/layers")).status, StatusCode::OK);
}

#[test]
fn events_end_with_the_job() {
    let bench = Bench::new();
    let id = bench.post("/v1/jobs", &json!({ "kind": "plan", "file": bench.shown("files/job.toml") })).json()
        ["id"]
        .clone();
    let events = bench.get(&format!("/v1/jobs/{id}/events"));
    assert_eq!(events.header("content-type"), "text/event-stream");
    let text = String::from_utf8(events.bytes).expect("text");
    let states: Vec<serde_json::Value> = text
        .lines()
        .filter_map(|l| l.strip_prefix("data: "))
        .map(|l| serde_json::from_str(l).expect("a state"))
        .collect();
    assert_eq!(states.last().expect("a state")["phase"], "done", "{text}");
    assert!(text.contains("id: 1"), "{text}");
}

#[test]
fn events_of_what_is_over_are_one() {
    let bench = Bench::new();
    let id = bench.square();
    let text = String::from_utf8(bench.get(&format!("/v1/jobs/{id}/events")).bytes).expect("text");
    assert_eq!(text.matches("data: ").count(), 1, "{text}");
}

/// The planner counts thousands of steps; the page gets ten states a second at most.
#[test]
fn events_do_not_grow_with_the_steps_of_the_planner() {
    let bench = Bench::new();
    let id = bench.post("/v1/jobs", &slow(&bench)).json()["id"].as_u64().expect("a number");
    std::thread::scope(|s| {
        // Cancelled after a second, from another studio thread: the stream below holds this one.
        let own = bench.router.clone();
        let request =
            bench.request("DELETE", &format!("/v1/jobs/{id}")).body(Body::empty()).expect("a request");
        s.spawn(move || {
            std::thread::sleep(Duration::from_secs(1));
            let runtime =
                tokio::runtime::Builder::new_current_thread().enable_all().build().expect("a runtime");
            runtime.block_on(async { tower::ServiceExt::oneshot(own, request).await.expect("an answer") });
        });
        let begun = Instant::now();
        let text = String::from_utf8(bench.get(&format!("/v1/jobs/{id}/events")).bytes).expect("text");
        let most = 10.0 * begun.elapsed().as_secs_f64() + 12.0;
        let n = text.matches("data: ").count();
        assert!(n > 1 && (n as f64) < most, "{n} events");
    });
}

// ---- layers ----

#[test]
fn the_index_tells_layers_roles_and_the_box_of_the_part() {
    let bench = Bench::new();
    let id = bench.square();
    let index = bench.get(&format!("/v1/jobs/{id}/layers")).json();
    assert_eq!(index["layers"].as_array().expect("layers").len(), 2);
    assert_eq!(
        (index["layers"][0]["z_mm"].as_f64(), index["layers"][0]["beads"].as_u64()),
        (Some(0.2), Some(4))
    );
    assert_eq!(index["speeds_mm_s"], json!([30.0, 50.0]));
    assert_eq!(index["classes"].as_array().expect("classes").len(), 18);
    assert_eq!(index["generator"], "Squares 1");
    let part = &index["part_mm"];
    // E 0.7 over 20 mm and 0.2 mm high is 0.464 mm wide.
    assert!((part[0][0].as_f64().expect("a number") - (10.0 - 0.5 * 0.464)).abs() < 2e-3, "{part}");
}

#[test]
fn layers_are_eight_bytes_a_record() {
    let bench = Bench::new();
    let id = bench.square();
    let index = bench.get(&format!("/v1/jobs/{id}/layers")).json();
    let records = |k: usize| index["layers"][k]["records"].as_u64().expect("a number") as usize;
    let length = |range: &str| bench.get(&format!("/v1/jobs/{id}/layers/{range}")).bytes.len();
    assert_eq!((length("0-0"), length("1-1")), (8 * records(0), 8 * records(1)));
    let both = bench.get(&format!("/v1/jobs/{id}/layers/0-1")).bytes;
    let apart: Vec<u8> =
        ["0-0", "1-1"].iter().flat_map(|r| bench.get(&format!("/v1/jobs/{id}/layers/{r}")).bytes).collect();
    assert_eq!(both, apart);
}

#[test]
fn packed_layers_unpack_to_the_same() {
    let bench = Bench::new();
    let id = bench.square();
    let plain = bench.get(&format!("/v1/jobs/{id}/layers/0-1"));
    let request =
        bench.request("GET", &format!("/v1/jobs/{id}/layers/0-1")).header("accept-encoding", "gzip");
    let packed = bench.raw(request.body(Body::empty()).expect("a request"));
    assert_eq!(packed.header("content-encoding"), "gzip");
    let mut unpacked = Vec::new();
    std::io::copy(&mut flate2::read::GzDecoder::new(&packed.bytes[..]), &mut unpacked).expect("gzip");
    assert_eq!(unpacked, plain.bytes);
}

#[test]
fn ranges_of_layers_are_checked() {
    let bench = Bench::new();
    let id = bench.square();
    for range in ["1-0", "0-2", "0", "a-b", "-1-0", "0-99999999999999999999", "", "0-0-0"] {
        let answer = bench.get(&format!("/v1/jobs/{id}/layers/{range}"));
        assert!(answer.status.is_client_error(), "{range}");
    }
}

#[test]
fn angles_to_the_load_are_sent_for_plans_with_a_guide_alone() {
    let bench = Bench::new();
    let text = format!("[shape]\nmesh = {:?}\n", bench.shown("files/part.stl"));
    let guided = bench.run(&json!({ "kind": "plan", "text": format!("{text}# follows a guide\n") }));
    let plain = bench.run(&json!({ "kind": "plan", "text": text }));
    let (guided, plain) = (&guided["id"], &plain["id"]);
    let told = |id: &serde_json::Value| bench.get(&format!("/v1/jobs/{id}/result")).json()["angles"].clone();
    assert_eq!((told(guided), told(plain)), (json!(true), json!(false)));
    // A byte for each record: beads count up from 0 in each layer, and what is no bead has none.
    let records = bench.get(&format!("/v1/jobs/{guided}/layers/0-1")).bytes;
    let angles = bench.get(&format!("/v1/jobs/{guided}/layers/0-1/angles")).bytes;
    assert_eq!(8 * angles.len(), records.len());
    let (mut bead, mut compared) = (0, 0);
    for (record, angle) in records.chunks(8).zip(&angles) {
        let kind = record[6] & 127;
        // Travels, starts and moves of filament come after the last role.
        if kind as usize >= grainpath_core::Role::ALL.len() {
            assert_eq!(*angle, 255);
            bead = if kind == grainpath_studio::records::START { 0 } else { bead };
            continue;
        }
        assert_eq!(usize::from(*angle), bead % 181);
        (bead, compared) = (bead + 1, compared + 1);
    }
    assert!(compared > 50, "{compared}");
    let none = bench.get(&format!("/v1/jobs/{plain}/layers/0-0/angles"));
    assert_eq!(none.status, StatusCode::NOT_FOUND);
    assert!(none.error().contains("follow no guide"), "{}", none.error());
    for range in ["1-0", "0-99999", "a-b"] {
        let answer = bench.get(&format!("/v1/jobs/{guided}/layers/{range}/angles"));
        assert_eq!(answer.status, StatusCode::BAD_REQUEST, "{range}");
    }
}

#[test]
fn reserves_are_sent_for_plans_that_tell_them_alone() {
    let bench = Bench::new();
    let text = format!("[shape]\nmesh = {:?}\n", bench.shown("files/part.stl"));
    let loaded = bench.run(&json!({ "kind": "plan", "text": format!("{text}# tells a reserve\n") }));
    let guided = bench.run(&json!({ "kind": "plan", "text": format!("{text}# follows a guide\n") }));
    let (loaded, guided) = (&loaded["id"], &guided["id"]);
    let told = |id: &serde_json::Value| bench.get(&format!("/v1/jobs/{id}/result")).json()["reserve"].clone();
    assert_eq!((told(loaded), told(guided)), (json!(true), json!(false)));
    let records = bench.get(&format!("/v1/jobs/{loaded}/layers/1-1")).bytes;
    let reserves = bench.get(&format!("/v1/jobs/{loaded}/layers/1-1/reserve")).bytes;
    assert_eq!(8 * reserves.len(), records.len());
    let is_bead = |record: &[u8]| usize::from(record[6] & 127) < grainpath_core::Role::ALL.len();
    let of_beads: Vec<u8> =
        records.chunks(8).zip(&reserves).filter(|(r, _)| is_bead(r)).map(|(_, byte)| *byte).collect();
    let wanted: Vec<u8> = (0..of_beads.len()).map(|k| 200 - (k % 181) as u8).collect();
    assert!(of_beads.len() > 20 && of_beads == wanted, "{of_beads:?}");
    let others = records.chunks(8).zip(&reserves).filter(|(r, _)| !is_bead(r));
    assert!(others.map(|(_, byte)| *byte).all(|byte| byte == 255), "travels have none");
    let none = bench.get(&format!("/v1/jobs/{guided}/layers/0-0/reserve"));
    assert_eq!(none.status, StatusCode::NOT_FOUND);
    assert!(none.error().contains("no reserve"), "{}", none.error());
}

#[test]
fn layers_tell_their_time_and_their_seams() {
    let bench = Bench::new();
    let state = bench.run(&json!({ "kind": "plan", "file": bench.shown("files/job.toml") }));
    let index = bench.get(&format!("/v1/jobs/{}/layers", state["id"])).json();
    let layers = index["layers"].as_array().expect("layers");
    let sum: f64 = layers.iter().map(|l| l["time_s"].as_f64().expect("a number")).sum();
    assert!((sum - index["time_s"].as_f64().expect("a number")).abs() < 0.01, "{sum} {}", index["time_s"]);
    // A box has one seam for each of its walls in each layer.
    assert!(layers.iter().all(|l| l["seams"].as_u64().is_some_and(|n| n > 0)), "{index}");
    assert!(index["flow_mm3_s"].as_f64().is_some_and(|f| f > 0.5), "{index}");
    let seams: usize = layers.iter().map(|l| l["seams"].as_u64().expect("a number") as usize).sum();
    let last = layers.len() - 1;
    let records = bench.get(&format!("/v1/jobs/{}/layers/0-{last}", state["id"])).bytes;
    assert_eq!(records.chunks(8).filter(|r| r[6] & 128 != 0).count(), seams);
}

/// A planned part of 200 x 100 mm: what the issue allows is 12 bytes a segment.
#[test]
fn a_planned_part_takes_at_most_twelve_bytes_a_segment() {
    let bench = Bench::new();
    fs::write(bench.path("files/plate.stl"), support::box_stl([100.0, 60.0, 3.0])).expect("written");
    for pattern in ["grid", "gyroid", "rectilinear"] {
        let text =
            format!("[shape]\nmesh = {:?}\n[fill]\npattern = {pattern:?}\n", bench.shown("files/plate.stl"));
        let state = bench.run(&json!({ "kind": "plan", "text": text }));
        let index = bench.get(&format!("/v1/jobs/{}/layers", state["id"])).json();
        let layers = index["layers"].as_array().expect("layers");
        let beads: u64 = layers.iter().map(|l| l["beads"].as_u64().expect("a number")).sum();
        let last = layers.len() - 1;
        let address = format!("/v1/jobs/{}/layers/0-{last}", state["id"]);
        let request = bench.request("GET", &address).header("accept-encoding", "gzip");
        let bytes = bench.raw(request.body(Body::empty()).expect("a request")).bytes.len();
        let each = bytes as f64 / beads as f64;
        assert!(each > 1.0 && each <= 12.0, "{pattern}: {each} bytes a segment");
    }
}

#[test]
fn what_a_job_wrote_is_sent_as_a_file() {
    let bench = Bench::new();
    let state = bench.run(&json!({ "kind": "plan", "file": bench.shown("files/job.toml") }));
    let answer = bench.get(&format!("/v1/jobs/{}/outputs/gcode", state["id"]));
    assert_eq!(answer.bytes, fs::read(bench.path("files/studio/job/part.gcode")).expect("there"));
    assert_eq!(answer.header("content-disposition"), "attachment; filename=\"part.gcode\"");
    let none = bench.get(&format!("/v1/jobs/{}/outputs/report", state["id"]));
    assert_eq!(none.status, StatusCode::NOT_FOUND);
}

#[test]
fn parts_layers_and_cases_have_pictures() {
    let bench = Bench::new();
    let program = bench.square();
    let shape = bench.run(&json!({ "kind": "shape", "text": "" }))["id"].clone();
    let stress = bench.run(&json!({ "kind": "stress", "text": "" }))["id"].clone();
    let layers = bench.get(&format!("/v1/jobs/{program}/layers")).json()["layers"].as_array().map(Vec::len);
    for (address, words) in [
        (format!("{program}/picture"), format!("part of {}", layers.expect("layers"))),
        (format!("{program}/layers/0-1/picture"), "layer 1".to_owned()),
        (format!("{shape}/picture"), "shape of 2".to_owned()),
        (format!("{stress}/stress/1/picture"), "stress of bend".to_owned()),
    ] {
        let answer = bench.get(&format!("/v1/jobs/{address}"));
        assert_eq!(
            (answer.status, answer.header("content-type")),
            (StatusCode::OK, "image/png"),
            "{address}"
        );
        assert_eq!(String::from_utf8(answer.bytes).expect("words"), words);
    }
    // What a job has not is missing, and a range beyond the layers is wrong.
    for (address, status) in [
        (format!("{stress}/picture"), StatusCode::NOT_FOUND),
        (format!("{stress}/stress/2/picture"), StatusCode::NOT_FOUND),
        (format!("{program}/layers/0-999/picture"), StatusCode::BAD_REQUEST),
        (format!("{shape}/stress/0/picture"), StatusCode::NOT_FOUND),
    ] {
        assert_eq!(bench.get(&format!("/v1/jobs/{address}")).status, status, "{address}");
    }
}

#[test]
fn a_job_without_a_test_has_no_damage() {
    let bench = Bench::new();
    let id = bench.square();
    let answer = bench.get(&format!("/v1/jobs/{id}/damage"));
    assert_eq!(
        (answer.status, answer.error().as_str()),
        (StatusCode::NOT_FOUND, "this job tested no strength")
    );
}

#[test]
fn the_schema_is_that_of_the_command_line() {
    assert_eq!(Bench::new().get("/v1/schema").json(), grainpath_job::json_schema());
}

#[test]
fn profiles_come_with_their_text() {
    let list = Bench::new().get("/v1/profiles").json();
    let rows = list["profiles"].as_array().expect("rows");
    assert_eq!(rows.len(), grainpath_job::PROFILES.len());
    let pla = rows.iter().find(|r| r["name"] == "pla").expect("pla");
    assert!(pla["toml"].as_str().expect("text").contains("strength_tier"));
}

// ---- starting ----

#[test]
fn wrong_options_are_refused() {
    use grainpath_studio::{Options, Studio};
    use std::sync::Arc;
    let dir = tempfile::tempdir().expect("a folder");
    let good = Options { work: dir.path().join("studio"), ..Options::default() };
    for (options, words) in [
        (Options { base: "grainpath".into(), ..good.clone() }, "--base"),
        (Options { base: "/a b".into(), ..good.clone() }, "--base"),
        (Options { base: "//other.example".into(), ..good.clone() }, "--base"),
        (Options { base: "/a/../b".into(), ..good.clone() }, "--base"),
        (Options { hosts: vec!["lab:8000".into()], ..good.clone() }, "a name alone"),
        (Options { hosts: vec!["http://lab".into()], ..good.clone() }, "a name alone"),
        (Options { roots: vec![dir.path().join("none")], ..good.clone() }, "no such file"),
        (Options { file: Some(dir.path().join("none.stl")), ..good.clone() }, "no such file"),
    ] {
        let refused = Studio::new(&options, Arc::new(support::Planner)).err().expect("refused");
        assert!(refused.message.contains(words), "{}", refused.message);
    }
    let named = Options {
        hosts: vec!["lab.example".into(), "[fd00::1]".into()],
        base: "/tools/grainpath/".into(),
        ..good
    };
    assert!(Studio::new(&named, Arc::new(support::Planner)).is_ok());
}

// ---- the description ----

/// `GRAINPATH_BLESS=1 cargo test -p grainpath-studio --test router openapi` writes it anew.
#[test]
fn openapi_is_what_is_committed() {
    let made = format!("{:#}\n", Bench::new().get("/v1/openapi.json").json());
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/openapi.json");
    if std::env::var_os("GRAINPATH_BLESS").is_some() {
        fs::write(path, &made).expect("written");
    }
    assert_eq!(made, fs::read_to_string(path).expect("committed"), "the interface changed");
}

#[test]
fn every_address_of_the_description_answers() {
    let bench = Bench::new();
    let id = bench.square();
    let described = grainpath_studio::description();
    let paths = described["paths"].as_object().expect("paths");
    assert!(paths.len() >= 14, "{}", paths.len());
    for (path, methods) in paths {
        let address =
            path.replace("{id}", &id.to_string()).replace("{range}", "0-0").replace("{kind}", "gcode");
        for method in methods.as_object().expect("methods").keys() {
            let request =
                bench.request(&method.to_uppercase(), &address).body(Body::empty()).expect("a request");
            let answer = bench.raw(request);
            let text = String::from_utf8_lossy(&answer.bytes).into_owned();
            assert!(
                !text.contains("no such address") && answer.status != StatusCode::METHOD_NOT_ALLOWED,
                "{method} {path}"
            );
        }
    }
}

/// Answers hold the keys that the description gives them, and no others.
#[test]
fn answers_have_the_keys_of_the_description() {
    let bench = Bench::new();
    let id = bench.square();
    let schemas = grainpath_studio::description()["components"]["schemas"].clone();
    let keys = |name: &str| -> Vec<String> {
        schemas[name]["properties"].as_object().unwrap_or_else(|| panic!("{name}")).keys().cloned().collect()
    };
    for (address, name) in [
        ("/v1/state".to_owned(), "Studio"),
        (format!("/v1/files?path={}", bench.shown("files")), "Listing"),
        (format!("/v1/text?path={}", bench.shown("files/job.toml")), "JobText"),
        ("/v1/jobs".to_owned(), "States"),
        (format!("/v1/jobs/{id}"), "State"),
        (format!("/v1/jobs/{id}/result"), "Result"),
        (format!("/v1/jobs/{id}/layers"), "Index"),
        ("/v1/history".to_owned(), "History"),
        ("/v1/profiles".to_owned(), "Profiles"),
        ("/v1/nothing".to_owned(), "Error"),
    ] {
        let answer = bench.get(&address).json();
        let mut found: Vec<String> =
            answer.as_object().expect("an object").keys().filter(|k| *k != "ok").cloned().collect();
        let mut wanted: Vec<String> = keys(name).into_iter().filter(|k| k != "ok").collect();
        found.sort();
        wanted.sort();
        assert_eq!(found, wanted, "{address}");
    }
}

// ---- the part and its stress ----

/// The numbers of an answer.
fn words(bytes: &[u8]) -> Vec<u32> {
    bytes.chunks_exact(4).map(|w| u32::from_le_bytes([w[0], w[1], w[2], w[3]])).collect()
}

fn reals(words: &[u32]) -> Vec<f32> {
    words.iter().map(|w| f32::from_bits(*w)).collect()
}

#[test]
fn the_surface_of_a_part_has_its_faces_and_its_open_edges() {
    let bench = Bench::new();
    let state = bench.run(&json!({ "kind": "shape", "text": "[shape]\n", "name": "plate" }));
    assert_eq!(
        (&state["phase"], &state["kind"], &state["title"]),
        (&json!("done"), &json!("shape"), &json!("plate"))
    );
    let answer = bench.get(&format!("/v1/jobs/{}/surface", state["id"]));
    assert_eq!(answer.header("content-type"), "application/octet-stream");
    let all = words(&answer.bytes);
    assert_eq!(all[..5], [4, 2, 1, 1, 1]);
    assert_eq!(reals(&all[5..17])[9..], [0.0, 3.0, 0.5]);
    assert_eq!(all[17..23], [0, 1, 2, 0, 2, 3]);
    assert_eq!(all[23..25], [7, u32::MAX]);
    assert_eq!(reals(&all[25..31]), [0.0, 0.0, 0.0, 2.0, 0.0, 0.25]);
    assert_eq!(all[31..33], [0, 2]);
    assert_eq!(reals(&all[33..]), [2.0, 0.0, 0.0, 2.0, 3.0, 0.75]);
}

#[test]
fn a_shape_is_shown_without_saving_its_text() {
    let bench = Bench::new();
    let before = fs::read_dir(bench.path("files/studio")).map_or(0, Iterator::count);
    let state = bench.run(&json!({ "kind": "shape", "text": "# mine\n" }));
    let report = bench.get(&format!("/v1/jobs/{}/result", state["id"])).json();
    assert_eq!(report["report"]["text"], "# mine\n");
    assert!(report["report"]["folder"].as_str().expect("a folder").ends_with("studio"));
    assert_eq!(fs::read_dir(bench.path("files/studio")).map_or(0, Iterator::count), before);
}

#[test]
fn poses_are_told_without_saving_the_text() {
    let bench = Bench::new();
    let before = fs::read_dir(bench.path("files/studio")).map_or(0, Iterator::count);
    let state = bench.run(&json!({ "kind": "orient", "text": "# mine\n", "name": "bar" }));
    assert_eq!(
        (&state["phase"], &state["kind"], &state["title"]),
        (&json!("done"), &json!("orient"), &json!("bar"))
    );
    let report = bench.get(&format!("/v1/jobs/{}/result", state["id"])).json();
    assert_eq!((&report["report"]["text"], &report["report"]["poses"]), (&json!("# mine\n"), &json!([])));
    assert_eq!(fs::read_dir(bench.path("files/studio")).map_or(0, Iterator::count), before);
}

#[test]
fn branches_of_supports_have_ten_numbers() {
    let bench = Bench::new();
    let state = bench.run(&json!({ "kind": "supports", "text": "[shape]\n" }));
    let answer = bench.get(&format!("/v1/jobs/{}/branches", state["id"]));
    let all = reals(&words(&answer.bytes));
    assert_eq!(all[..10], [1.0, 2.0, 3.0, 0.25, 1.0, 2.5, 0.0, 4.0, 0.5, 1.0]);
    assert_eq!(all[10..], [0.0; 10]);
    let none = bench.get(&format!("/v1/jobs/{}/branches", bench.square()));
    assert_eq!(
        (none.status, none.json()["error"].as_str()),
        (StatusCode::NOT_FOUND, Some("this job grew no supports"))
    );
}

#[test]
fn a_shape_of_a_job_file_is_that_of_its_folder() {
    let bench = Bench::new();
    let state = bench.run(&json!({ "kind": "shape", "file": bench.shown("files/job.toml") }));
    let report = bench.get(&format!("/v1/jobs/{}/result", state["id"])).json();
    assert!(report["report"]["folder"].as_str().expect("a folder").ends_with("files"));
    let refused =
        bench.post("/v1/jobs", &json!({ "kind": "shape", "file": bench.shown("secret/key.gcode") }));
    assert_eq!(refused.status, StatusCode::UNPROCESSABLE_ENTITY);
    let both = json!({ "kind": "stress", "text": "", "file": bench.shown("files/job.toml") });
    assert!(bench.post("/v1/jobs", &both).error().contains("either"));
}

#[test]
fn every_load_case_has_nine_values_a_point() {
    let bench = Bench::new();
    let state = bench.run(&json!({ "kind": "stress", "text": "" }));
    let id = &state["id"];
    assert_eq!(bench.get(&format!("/v1/jobs/{id}/result")).json()["cases"], json!(["pull", "bend"]));
    let all = words(&bench.get(&format!("/v1/jobs/{id}/stress")).bytes);
    assert_eq!((all.len(), &all[..2], &all[11..]), (14, &[3, 1][..], &[0, 1, 2][..]));
    let bend = reals(&words(&bench.get(&format!("/v1/jobs/{id}/stress/1")).bytes));
    assert_eq!(bend.len(), 27);
    assert_eq!(bend[10..13], [-5.5, -6.0, -6.5]);
    for wrong in ["stress/2", "surface", "damage"] {
        assert_eq!(bench.get(&format!("/v1/jobs/{id}/{wrong}")).status, StatusCode::NOT_FOUND, "{wrong}");
    }
}

#[test]
fn surfaces_are_sent_packed_to_those_who_unpack() {
    let bench = Bench::new();
    let state = bench.run(&json!({ "kind": "shape", "text": "" }));
    let address = format!("/v1/jobs/{}/surface", state["id"]);
    let request = bench.request("GET", &address).header("accept-encoding", "gzip");
    let packed = bench.raw(request.body(Body::empty()).expect("a request"));
    assert_eq!(packed.header("content-encoding"), "gzip");
    let mut plain = Vec::new();
    std::io::Read::read_to_end(&mut flate2::read::GzDecoder::new(&packed.bytes[..]), &mut plain)
        .expect("gzip");
    assert_eq!(plain, bench.get(&address).bytes);
}

#[test]
fn a_section_of_a_load_case_has_the_values_between_its_points() {
    let bench = Bench::new();
    let state = bench.run(&json!({ "kind": "stress", "text": "" }));
    let at = |what: &str| bench.get(&format!("/v1/jobs/{}/stress/{what}", state["id"]));
    let all = words(&at("1/section?axis=z&at=0.5").bytes);
    assert_eq!((all.len(), &all[..2]), (2 + 9 + 3 + 27, &[3, 1][..]));
    let points = reals(&all[2..11]);
    assert!(points.chunks(3).all(|p| p[2] == 0.5), "{points:?}");
    // The values are 0, -0.5, -1 and -1.5 at the corners, the last one above the plane.
    let mut values: Vec<f32> = reals(&all[14..]).chunks(9).map(|v| v[8]).collect();
    values.sort_by(f32::total_cmp);
    assert_eq!(values, [-1.25, -1.0, -0.75]);
    assert_eq!(words(&at("0/section?axis=x&at=3").bytes), [0, 0]);
    assert_eq!(at("2/section?axis=z&at=0.5").status, StatusCode::NOT_FOUND);
    for wrong in ["0/section?axis=w&at=1", "0/section?axis=x", "0/section?axis=x&at=one"] {
        assert_eq!(at(wrong).status, StatusCode::BAD_REQUEST, "{wrong}");
    }
}

#[test]
fn principal_lines_are_sent_with_the_stress_along_them() {
    let bench = Bench::new();
    let state = bench.run(&json!({ "kind": "stress", "text": "" }));
    let all = words(&bench.get(&format!("/v1/jobs/{}/stress/0/lines", state["id"])).bytes);
    assert_eq!(all[..3], [2, 2, 1]);
    assert_eq!(reals(&all[3..]), [0.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 2.0, 0.0, 1.0, 0.0, -1.0]);
    let id = bench.square();
    assert_eq!(bench.get(&format!("/v1/jobs/{id}/stress/0/lines")).status, StatusCode::NOT_FOUND);
}

#[test]
fn a_run_that_the_history_does_not_take_says_so_and_is_done() {
    let bench = Bench::new();
    fs::create_dir_all(bench.path("files/studio/history.jsonl")).expect("a folder in its place");
    let state = bench.run(&json!({ "kind": "plan", "file": bench.shown("files/job.toml") }));
    assert_eq!(state["phase"], "done");
    let warnings = bench.get(&format!("/v1/jobs/{}/result", state["id"])).json()["warnings"].clone();
    let told = warnings.as_array().expect("a list").last().expect("a warning").clone();
    assert_eq!(told["id"], "history-not-written");
    assert!(told["text"].as_str().expect("words").contains("history.jsonl: "), "{told}");
}

#[test]
fn the_history_outlives_the_studio_and_bears_broken_lines() {
    let bench = Bench::new();
    let told = |bench: &Bench| bench.get("/v1/history").json()["runs"].as_array().expect("a list").clone();
    assert!(told(&bench).is_empty());
    let job = bench.shown("files/job.toml");
    assert_eq!(bench.run(&json!({ "kind": "plan", "file": job }))["phase"], "done");
    bench.square();
    assert_eq!(bench.run(&json!({ "kind": "strength", "file": job }))["phase"], "failed");
    let runs = told(&bench);
    assert_eq!(runs.len(), 1, "views and what failed leave no line: {runs:?}");
    let (run, of) = (&runs[0], |key: &str| &runs[0][key]);
    assert_eq!((of("kind"), of("name"), of("input")), (&json!("plan"), &json!("job"), &json!(job)));
    assert_eq!((of("mass_g"), of("time_s"), of("strength")), (&json!(1.5), &json!(60.0), &json!(null)));
    assert!(run["at_s"].as_u64().expect("a time") > 1_700_000_000);
    // Another start in the same folder, after another program wrote into the file.
    let file = bench.path("files/studio/history.jsonl");
    let kept = fs::read_to_string(&file).expect("there");
    fs::write(&file, format!("{kept}half a li\n[1]\n{}\n", kept.trim().replace("\"plan\"", "\"strength\"")))
        .expect("written");
    let runs = told(&bench);
    assert_eq!(
        runs.iter().map(|r| r["kind"].as_str().expect("a kind")).collect::<Vec<_>>(),
        ["strength", "plan"]
    );
}
