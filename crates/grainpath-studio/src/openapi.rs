//! The description of the interface for programs, as OpenAPI 3.1 (`GET /v1/openapi.json`).
//!
//! The router is made from the same rows, so the description and the server have the same addresses. The committed
//! `openapi.json` is the output of this module; a test compares both, so that every change of the interface shows there.

use serde_json::{Map, Value, json};

/// The kind of answer of an address.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Answers {
    /// JSON of this schema.
    Json(&'static str),
    /// Bytes.
    Bytes,
    /// A picture as PNG.
    Png,
    /// States of a job as server-sent events.
    Events,
    /// The status alone, without a body.
    Nothing,
}

/// The kind of body of a request.
#[derive(Debug, Clone, Copy)]
enum Takes {
    Nothing,
    /// JSON of this schema.
    Json(&'static str),
    /// Bytes.
    Bytes,
    /// The text of a job.
    Text,
}

/// Variable parts of addresses, with their types.
const IN_PATH: [(&str, &str); 4] =
    [("id", "integer"), ("range", "string"), ("kind", "string"), ("case", "integer")];

/// What an argument of the query is.
#[derive(Debug, Clone, Copy)]
enum Form {
    Text,
    Number,
    /// One of these words.
    OneOf(&'static [&'static str]),
}

/// An address of the interface.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Route {
    pub path: &'static str,
    method: &'static str,
    /// The name of the operation.
    name: &'static str,
    about: &'static str,
    /// Arguments of the query: name, meaning and form.
    query: &'static [(&'static str, &'static str, Form)],
    body: Takes,
    /// Status of success.
    status: &'static str,
    answers: Answers,
}

impl Route {
    const fn get(path: &'static str, name: &'static str, about: &'static str, answers: Answers) -> Self {
        Self { path, method: "get", name, about, query: &[], body: Takes::Nothing, status: "200", answers }
    }
}

pub(crate) const STATE: Route = Route::get(
    "/v1/state",
    "state",
    "Version, folders, the file that is opened first.",
    Answers::Json("Studio"),
);
pub(crate) const FILES: Route = Route {
    query: &[("path", "A folder below one of the roots.", Form::Text)],
    ..Route::get("/v1/files", "files", "The files of a folder.", Answers::Json("Listing"))
};
pub(crate) const TEXT: Route = Route {
    query: &[("path", "A job file (.toml).", Form::Text)],
    ..Route::get("/v1/text", "text", "The text of a job file.", Answers::Json("JobText"))
};
pub(crate) const SAVE: Route = Route {
    method: "post",
    query: &[("path", "A new job file (.toml); a relative one is below the working folder.", Form::Text)],
    body: Takes::Text,
    status: "201",
    ..Route::get(
        "/v1/text",
        "save",
        "Writes the text of a job under a new name below the working folder; 409 where the name is taken.",
        Answers::Json("Upload"),
    )
};
pub(crate) const PICTURE: Route = Route {
    query: &[("path", "A photograph (PNG, JPEG, BMP).", Form::Text)],
    ..Route::get("/v1/picture", "picture", "The bytes of a photograph.", Answers::Bytes)
};
pub(crate) const JOB_FOR: Route = Route {
    query: &[("path", "A mesh, a drawing, a photograph, a scan, or the folder of one.", Form::Text)],
    ..Route::get(
        "/v1/job",
        "jobFor",
        "The text of a job that plans this file with defaults.",
        Answers::Json("JobText"),
    )
};
pub(crate) const EXAMPLES: Route = Route::get(
    "/v1/examples",
    "examples",
    "The examples: what `grainpath new` writes.",
    Answers::Json("Examples"),
);
pub(crate) const EXAMPLE: Route = Route {
    method: "post",
    query: &[("name", "One of the examples.", Form::Text)],
    ..Route::get(
        "/v1/examples",
        "example",
        "Writes an example to a new folder below the working folder; answers the path of its job.",
        Answers::Json("Upload"),
    )
};
pub(crate) const UPLOAD: Route = Route {
    method: "post",
    query: &[(
        "name",
        "The file's name; unsafe characters are replaced, and a taken name gets a number.",
        Form::Text,
    )],
    body: Takes::Bytes,
    ..Route::get("/v1/uploads", "upload", "Streams the body to a file.", Answers::Json("Upload"))
};
pub(crate) const LIST: Route =
    Route::get("/v1/jobs", "jobs", "The states of all jobs, oldest first.", Answers::Json("States"));
pub(crate) const BEGIN: Route = Route {
    method: "post",
    body: Takes::Json("Wanted"),
    status: "202",
    ..Route::get("/v1/jobs", "begin", "Puts a job into the queue.", Answers::Json("State"))
};
pub(crate) const CHECK: Route = Route {
    method: "post",
    body: Takes::Text,
    ..Route::get(
        "/v1/check",
        "check",
        "Reads the text of a job without running it, and answers with its first error.",
        Answers::Json("Checked"),
    )
};
pub(crate) const ONE: Route =
    Route::get("/v1/jobs/{id}", "job", "The state of a job.", Answers::Json("State"));
pub(crate) const CANCEL: Route = Route {
    method: "delete",
    status: "204",
    ..Route::get("/v1/jobs/{id}", "cancel", "Cancels a job.", Answers::Nothing)
};
pub(crate) const EVENTS: Route = Route::get(
    "/v1/jobs/{id}/events",
    "events",
    "States of a job until it is over, at most ten a second.",
    Answers::Events,
);
pub(crate) const RESULT: Route = Route::get(
    "/v1/jobs/{id}/result",
    "result",
    "The report of the command line, warnings, files that were written.",
    Answers::Json("Result"),
);
pub(crate) const LAYERS: Route = Route::get(
    "/v1/jobs/{id}/layers",
    "layers",
    "The index of a program: layers, roles, speeds, the box of the part. While a job is planned it has the first layers, and `more` is true.",
    Answers::Json("Index"),
);
pub(crate) const RECORDS: Route = Route::get(
    "/v1/jobs/{id}/layers/{range}",
    "records",
    "Layers FIRST-LAST, counted from 0, one after the other: eight bytes a record.",
    Answers::Bytes,
);
pub(crate) const ANGLES: Route = Route::get(
    "/v1/jobs/{id}/layers/{range}/angles",
    "angles",
    "The angle of each record of these layers to the direction that the guide asks for: a byte in halves of a degree, 255 where there is none; of plans with a guide, once they are done.",
    Answers::Bytes,
);
pub(crate) const RESERVE: Route = Route::get(
    "/v1/jobs/{id}/layers/{range}/reserve",
    "reserve",
    "The reserve of each record of these layers, the factor on the loads at which the bead first fails, with nominal strengths, least of all load cases: a byte b for the factor 2^((b - 80) / 20), where 0 is that or less and 254 that or more; 255 where there is none. Of plans that tell a reserve, once they are done.",
    Answers::Bytes,
);
pub(crate) const PART_PICTURE: Route = Route::get(
    "/v1/jobs/{id}/picture",
    "partPicture",
    "The part as a picture: the beads of a program, or the numbered faces of a shape.",
    Answers::Png,
);
pub(crate) const LAYER_PICTURE: Route = Route::get(
    "/v1/jobs/{id}/layers/{range}/picture",
    "layerPicture",
    "The last of these layers as a picture, seen from above.",
    Answers::Png,
);
pub(crate) const CASE_PICTURE: Route = Route::get(
    "/v1/jobs/{id}/stress/{case}/picture",
    "casePicture",
    "The von Mises stress of a load case as a picture: blue at 0, red at the largest.",
    Answers::Png,
);
pub(crate) const DAMAGE: Route = Route::get(
    "/v1/jobs/{id}/damage",
    "damage",
    "Elements that broke: x, y, z in mm, the share of stiffness lost, and the first state of the test in which it is broken, counted from 0 as in the result; as 32-bit floats.",
    Answers::Bytes,
);
pub(crate) const SURFACE: Route = Route::get(
    "/v1/jobs/{id}/surface",
    "surface",
    "The part as it is placed, 32 bits a number: counts of vertices, triangles, faulty edges, borders and faults of the file; x, y, z of the vertices; corners of the triangles; the face of each triangle, counted from 0 as in the report, or 4294967295; both ends of each faulty edge; corners of each border between two faces; both ends of each fault of the file before it was mended.",
    Answers::Bytes,
);
pub(crate) const PART_FILE: Route = Route::get(
    "/v1/jobs/{id}/part-file",
    "partFile",
    "The file that a shape was read from, and whether it has changed on the disk since.",
    Answers::Json("PartFile"),
);
pub(crate) const STRESSED: Route = Route::get(
    "/v1/jobs/{id}/stress",
    "stressed",
    "The surface that was solved, 32 bits a number: counts of points and triangles; x, y, z of the points; corners of the triangles.",
    Answers::Bytes,
);
pub(crate) const CASE: Route = Route::get(
    "/v1/jobs/{id}/stress/{case}",
    "case",
    "The values of a load case, counted from 0, at the points of the surface that was solved: stress xx, yy, zz, xy, yz, zx in MPa and displacement x, y, z in mm, as 32-bit floats.",
    Answers::Bytes,
);
pub(crate) const SECTION: Route = Route {
    query: &[
        ("axis", "The axis across which the section lies.", Form::OneOf(&["x", "y", "z"])),
        ("at", "Position of the section on this axis, mm.", Form::Number),
    ],
    ..Route::get(
        "/v1/jobs/{id}/stress/{case}/section",
        "section",
        "A section of the solid that was solved, 32 bits a number: counts of points and triangles; x, y, z of the points; corners of the triangles; for each point the nine values of the load case.",
        Answers::Bytes,
    )
};
pub(crate) const LINES: Route = Route::get(
    "/v1/jobs/{id}/stress/{case}/lines",
    "lines",
    "Principal stress lines, 32 bits a number: the count of lines; the count of points of each; x, y, z in mm and the stress along the line in MPa of each point.",
    Answers::Bytes,
);
pub(crate) const BRANCHES: Route = Route::get(
    "/v1/jobs/{id}/branches",
    "branches",
    "Branches of the supports, 32 bits a number: for each x, y, z and radius of its upper end and of its lower end in mm, the load that it carries in N, and 1 if its upper end touches the part.",
    Answers::Bytes,
);
pub(crate) const HISTORY: Route = Route::get(
    "/v1/history",
    "history",
    "Plans and strength tests of this working folder, the last one first; earlier starts of the studio too.",
    Answers::Json("History"),
);
pub(crate) const DRAFTS: Route = Route::get(
    "/v1/drafts",
    "drafts",
    "Changes of files that were not saved, the last one first; earlier starts of the studio too.",
    Answers::Json("Drafts"),
);
pub(crate) const KEEP: Route = Route {
    method: "put",
    body: Takes::Json("Draft"),
    status: "204",
    ..Route::get(
        "/v1/drafts",
        "keep",
        "Keeps changes of a file that were not saved, in place of earlier ones. A text that is that of the file is forgotten.",
        Answers::Nothing,
    )
};
pub(crate) const OUTPUT: Route =
    Route::get("/v1/jobs/{id}/outputs/{kind}", "output", "A file that the job wrote.", Answers::Bytes);
pub(crate) const SCHEMA: Route = Route::get(
    "/v1/schema",
    "schema",
    "The JSON Schema of job files: what `grainpath schema` prints.",
    Answers::Json("Object"),
);
pub(crate) const PROFILES: Route =
    Route::get("/v1/profiles", "profiles", "Profiles with their text.", Answers::Json("Profiles"));
pub(crate) const OPENAPI: Route =
    Route::get("/v1/openapi.json", "openapi", "This description.", Answers::Json("Object"));

fn reference(name: &str) -> Value {
    json!({ "$ref": format!("#/components/schemas/{name}") })
}

fn content(kind: &str, schema: &Value) -> Value {
    let mut content = Map::new();
    content.insert(kind.to_owned(), json!({ "schema": schema }));
    Value::Object(content)
}

fn operation(route: &Route) -> Value {
    let bytes = json!({ "type": "string", "format": "binary" });
    let success = match route.answers {
        Answers::Json(schema) => {
            json!({ "description": "Done.", "content": content("application/json", &reference(schema)) })
        }
        Answers::Bytes => {
            json!({ "description": "Bytes.", "content": content("application/octet-stream", &bytes) })
        }
        Answers::Png => json!({ "description": "A picture.", "content": content("image/png", &bytes) }),
        Answers::Events => {
            json!({ "description": "Each event is a state.", "content": content("text/event-stream", &reference("State")) })
        }
        Answers::Nothing => json!({ "description": "Done." }),
    };
    let mut responses = Map::new();
    responses.insert(route.status.to_owned(), success);
    for (status, words) in [
        ("401", "The token is missing or wrong."),
        ("403", "The host is not allowed, or another page asks."),
        ("4XX", "The sentence that the command line prints."),
    ] {
        let schema = content("application/json", &reference("Error"));
        responses.insert(status.to_owned(), json!({ "description": words, "content": schema }));
    }
    let is_in = |name: &str| route.path.contains(&format!("{{{name}}}"));
    let in_path = IN_PATH.iter().filter(|(name, _)| is_in(name)).map(
        |(name, kind)| json!({ "name": name, "in": "path", "required": true, "schema": { "type": kind } }),
    );
    let in_query = route.query.iter().map(|(name, about, form)| {
        let schema = match form {
            Form::Text => json!({ "type": "string" }),
            Form::Number => json!({ "type": "number" }),
            Form::OneOf(words) => json!({ "type": "string", "enum": words }),
        };
        json!({ "name": name, "in": "query", "required": true, "description": about, "schema": schema })
    });
    let mut operation = json!({
        "operationId": route.name, "summary": route.about,
        "parameters": in_path.chain(in_query).collect::<Vec<Value>>(), "responses": responses,
    });
    let body = match route.body {
        Takes::Nothing => return operation,
        Takes::Json(schema) => content("application/json", &reference(schema)),
        Takes::Bytes => content("application/octet-stream", &bytes),
        Takes::Text => content("text/plain", &json!({ "type": "string" })),
    };
    operation["requestBody"] = json!({ "required": true, "content": body });
    operation
}

/// The schemas of bodies and answers.
fn schemas() -> Value {
    let (text, number, whole) =
        (json!({ "type": "string" }), json!({ "type": "number" }), json!({ "type": "integer" }));
    let maybe = |kind: &str| json!({ "type": [kind, "null"] });
    let list = |of: &Value| json!({ "type": "array", "items": of });
    let object = |properties: Value| json!({ "type": "object", "properties": properties });
    let job = |kind: &str, more: Value| {
        let mut schema = object(json!({
            "kind": { "const": kind },
            "file": { "type": "string", "description": "A job file, run as it is." },
            "text": { "type": "string", "description": "The text of a job, saved before it runs." },
            "name": { "type": "string", "description": "Name of the folder of the run." },
            "shown": { "type": "string", "description": "The text of the file as the client shows it. A file that reads otherwise by now is refused." },
        }));
        schema["required"] = json!(["kind"]);
        schema["additionalProperties"] = json!(false);
        for (key, value) in more.as_object().cloned().unwrap_or_default() {
            schema["properties"][key] = value;
        }
        schema
    };
    let kind = json!({ "enum": ["job", "mesh", "outline", "photo", "scan", "program", "other"] });
    let draft = object(json!({ "path": text, "kind": kind,
        "text": { "type": "string", "description": "The changed text." },
        "from": { "type": "string", "description": "The text of the file that was changed." },
        "page": { "type": "string", "description": "The page that sends it; empty for none." },
        "change": { "type": "integer", "description": "The number of the change among those of the page. A change is left out where a later one of its page has come." },
        "at_s": { "type": "integer", "description": "Seconds since 1970; set by the server." } }));
    let mut kept = draft.clone();
    kept["required"] = json!(["path", "kind", "text", "from"]);
    kept["additionalProperties"] = json!(false);
    let layer = object(json!({ "z_mm": number, "height_mm": number, "records": whole, "beads": whole,
        "printed_mm": number, "volume_mm3": number, "time_s": number, "seams": whole }));
    json!({
        "Draft": kept,
        "Drafts": object(json!({ "drafts": list(&draft) })),
        "Checked": object(json!({ "ok": { "type": "boolean" }, "error": maybe("string") })),
        "Error": object(json!({ "ok": { "const": false }, "error": text })),
        "Object": { "type": "object" },
        "PartFile": object(json!({ "path": text, "changed": { "type": "boolean" } })),
        "Studio": object(json!({ "version": text, "work": text, "roots": list(&text), "max_upload_bytes": whole,
            "opened": { "type": ["object", "null"], "properties": { "path": text, "kind": text } } })),
        "Listing": object(json!({ "path": text, "parent": maybe("string"), "left_out": whole,
            "folders": list(&object(json!({ "name": text, "path": text }))),
            "files": list(&object(json!({ "name": text, "path": text, "bytes": whole,
                "kind": kind }))) })),
        "Examples": object(json!({ "examples": list(&object(json!({ "name": text, "about": text }))) })),
        "JobText": object(json!({ "text": text, "folder": text })),
        "Upload": object(json!({ "path": text, "bytes": whole })),
        "Wanted": { "oneOf": [
            { "type": "object", "required": ["kind", "file"], "additionalProperties": false,
              "properties": { "kind": { "const": "view" }, "file": text } },
            job("shape", json!({})),
            job("stress", json!({})),
            job("orient", json!({})),
            job("supports", json!({})),
            job("plan", json!({})),
            job("strength", json!({ "program": { "type": "string", "description": "G-code of any slicer." } })),
        ] },
        "State": object(json!({ "id": whole, "kind": { "enum": ["view", "shape", "stress", "orient", "supports", "plan", "strength"] }, "title": text,
            "phase": { "enum": ["waiting", "running", "done", "failed", "cancelled"] }, "ahead": whole,
            "stage": maybe("string"), "done": whole, "total": whole, "layers": { "type": "boolean" }, "ready": whole, "elapsed_s": number,
            "error": maybe("string"), "code": maybe("integer") })),
        "States": object(json!({ "jobs": list(&reference("State")) })),
        "Result": object(json!({ "report": { "type": "object" }, "angles": { "type": "boolean" }, "reserve": { "type": "boolean" }, "warnings": list(&json!({ "type": "object" })),
            "outputs": list(&object(json!({ "kind": text, "path": text }))),
            "cases": { "type": ["array", "null"], "items": text },
            "damage": { "type": ["object", "null"], "properties":
                { "cell_mm": list(&number), "angle_rad": number, "cells": whole, "states": list(&list(&number)) } } })),
        "History": object(json!({ "runs": list(&object(json!({ "at_s": whole, "kind": text, "name": text,
            "input": maybe("string"), "mass_g": maybe("number"), "time_s": maybe("number"), "layers": maybe("integer"),
            "filament_mm": maybe("number"), "strength": { "type": ["object", "null"] } }))) })),
        "Index": object(json!({ "origin_mm": list(&number), "step_mm": number, "classes": list(&text),
            "speeds_mm_s": list(&number), "part_mm": list(&list(&number)), "widths_mm": list(&number), "flow_mm3_s": number, "more": { "type": "boolean" }, "records": whole, "pulls": list(&whole),
            "generator": maybe("string"), "time_s": number, "filament_mm": number,
            "shares": list(&object(json!({ "beads": whole, "length_mm": number }))),
            "layers": list(&layer) })),
        "Profiles": object(json!({ "profiles":
            list(&object(json!({ "kind": text, "name": text, "about": text, "toml": text }))) })),
    })
}

/// The description of these addresses.
pub(crate) fn description(routes: &[Route]) -> Value {
    let mut paths = Map::new();
    for route in routes {
        let path = paths.entry(route.path).or_insert_with(|| json!({}));
        path[route.method] = operation(route);
    }
    json!({
        "openapi": "3.1.0",
        "info": {
            "title": "grainpath studio", "version": "1",
            "description": "The local server of `grainpath studio`. Every request needs the token of its start.",
            "license": { "name": "MIT OR Apache-2.0", "identifier": "MIT OR Apache-2.0" },
        },
        "security": [{ "token": [] }],
        "paths": paths,
        "components": {
            "securitySchemes": { "token": { "type": "http", "scheme": "bearer" } },
            "schemas": schemas(),
        },
    })
}
