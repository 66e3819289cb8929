//! The list of everything inside the program: a software bill of materials in CycloneDX 1.5 JSON.
//!
//! [`write`] takes the crates that the program is built with from `cargo metadata` (without those of tests and build
//! scripts), their checksums from `Cargo.lock`, and the npm packages that are bundled into the studio's page from
//! `web/package-lock.json` (without those of development). There is no date and no serial number: the same sources
//! give the same bytes.
//!
//! Source: CycloneDX 1.5 (ECMA-424), package URLs of github.com/package-url/purl-spec.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use base64::Engine as _;
use serde_json::{Value, json};

/// Writes the list to a file, or below the target folder.
pub fn run(words: &[&str]) -> Result<(), String> {
    let path = match words {
        [] => crate::target().join("grainpath.cdx.json"),
        [path] => Path::new(path).to_owned(),
        _ => return Err("usage: cargo xtask sbom [FILE]".to_owned()),
    };
    let list = list()?;
    let n = list["components"].as_array().map_or(0, Vec::len);
    fs::write(&path, text(&list)?).map_err(|e| format!("{}: {e}", path.display()))?;
    println!("{}: {n} libraries", path.display());
    Ok(())
}

/// The list as it is written.
pub fn text(list: &Value) -> Result<String, String> {
    serde_json::to_string_pretty(list).map(|t| t + "\n").map_err(|e| e.to_string())
}

/// The list of this checkout.
pub fn list() -> Result<Value, String> {
    let read = |name: &str| fs::read_to_string(crate::root().join(name)).map_err(|e| format!("{name}: {e}"));
    let lock: toml::Table = read("Cargo.lock")?.parse().map_err(|e| format!("Cargo.lock: {e}"))?;
    let page: Value = serde_json::from_str(&read("web/package-lock.json")?)
        .map_err(|e| format!("web/package-lock.json: {e}"))?;
    bill(&crate::arrows::metadata(&[])?, &lock, &page)
}

fn bill(metadata: &Value, lock: &toml::Table, page: &Value) -> Result<Value, String> {
    let used = crate::licences::used_by("grainpath-cli", metadata)?;
    let sums = checksums(lock);
    let text = |package: &Value, key: &str| package[key].as_str().unwrap_or_default().to_owned();
    let packages = metadata["packages"].as_array().cloned().unwrap_or_default();
    let mut names = BTreeMap::new();
    let mut components = Vec::new();
    let mut program = Value::Null;
    for package in packages.iter().filter(|p| used.contains(&text(p, "id"))) {
        let (name, version) = (text(package, "name"), text(package, "version"));
        let purl = format!("pkg:cargo/{name}@{version}");
        names.insert(text(package, "id"), purl.clone());
        let is_program = name == "grainpath-cli";
        let mut component = json!({
            "type": if is_program { "application" } else { "library" },
            "bom-ref": purl, "name": name, "version": version,
            "licenses": [{ "expression": expression(&text(package, "license")) }], "purl": purl,
        });
        if let Some(sum) = sums.get(&(name, version)) {
            component["hashes"] = json!([{ "alg": "SHA-256", "content": sum }]);
        }
        if is_program { program = component } else { components.push(component) }
    }
    let mut bundled = bundled(page)?;
    let mut needs: Vec<Value> = Vec::new();
    for node in metadata["resolve"]["nodes"].as_array().into_iter().flatten() {
        let Some(name) = names.get(node["id"].as_str().unwrap_or_default()) else { continue };
        let normal = |d: &&Value| {
            d["dep_kinds"].as_array().is_some_and(|kinds| kinds.iter().any(|k| k["kind"].is_null()))
        };
        let below = node["deps"].as_array().into_iter().flatten().filter(normal);
        let mut below: Vec<&String> =
            below.filter_map(|d| names.get(d["pkg"].as_str().unwrap_or_default())).collect();
        below.sort();
        let mut entry = json!({ "ref": name, "dependsOn": below });
        if name.starts_with("pkg:cargo/grainpath-studio@") {
            let of_page = bundled.iter().map(|c| c["bom-ref"].clone());
            entry["dependsOn"].as_array_mut().into_iter().for_each(|list| list.extend(of_page.clone()));
        }
        needs.push(entry);
    }
    components.append(&mut bundled);
    let order = |key: &'static str| move |v: &Value| v[key].as_str().unwrap_or_default().to_owned();
    components.sort_by_key(order("bom-ref"));
    needs.sort_by_key(order("ref"));
    Ok(json!({
        "bomFormat": "CycloneDX", "specVersion": "1.5", "version": 1,
        "metadata": { "component": program }, "components": components, "dependencies": needs,
    }))
}

/// Old manifests join licences by a slash, which SPDX does not know.
fn expression(licence: &str) -> String {
    licence.replace(" / ", " OR ").replace('/', " OR ")
}

/// SHA-256 of each package that comes from a registry.
fn checksums(lock: &toml::Table) -> BTreeMap<(String, String), String> {
    let packages = lock.get("package").and_then(toml::Value::as_array).cloned().unwrap_or_default();
    let text = |p: &toml::Value, key: &str| p.get(key).and_then(toml::Value::as_str).map(str::to_owned);
    let sum = |p: &toml::Value| Some(((text(p, "name")?, text(p, "version")?), text(p, "checksum")?));
    packages.iter().filter_map(sum).collect()
}

/// The npm packages that are in the page: all that are not for development.
fn bundled(page: &Value) -> Result<Vec<Value>, String> {
    let mut out = Vec::new();
    for (path, package) in page["packages"].as_object().into_iter().flatten() {
        let Some(name) = path.rsplit_once("node_modules/").map(|(_, name)| name) else { continue };
        if package["dev"] == true || package["devOptional"] == true {
            continue;
        }
        let field = |key: &str| package[key].as_str().ok_or_else(|| format!("{path} states no {key}"));
        let version = field("version")?;
        // The at sign of a scope is escaped in a package URL.
        let purl = format!("pkg:npm/{}@{version}", name.replace('@', "%40"));
        let sum = field("integrity")?.strip_prefix("sha512-").unwrap_or_default();
        let sum =
            base64::engine::general_purpose::STANDARD.decode(sum).map_err(|e| format!("{path}: {e}"))?;
        let sum: String = sum.iter().map(|b| format!("{b:02x}")).collect();
        out.push(json!({
            "type": "library", "bom-ref": purl, "name": name, "version": version,
            "hashes": [{ "alg": "SHA-512", "content": sum }],
            "licenses": [{ "expression": field("license")? }], "purl": purl,
        }));
    }
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_library_of_the_notices_is_listed_with_its_checksum() {
        let list = list().unwrap();
        let notices = fs::read_to_string(crate::root().join("crates/grainpath-cli/licences.txt")).unwrap();
        let table = notices.lines().skip(2).take_while(|l| !l.is_empty());
        let mut crates: Vec<String> = table
            .map(|l| l.split_whitespace().take(2).collect::<Vec<_>>().join("@"))
            .map(|name| format!("pkg:cargo/{name}"))
            .collect();
        crates.sort();
        assert!(crates.len() > 100, "{}", crates.len());
        let components = list["components"].as_array().unwrap();
        let from_registry = components.iter().filter(|c| c["hashes"][0]["alg"] == "SHA-256");
        let found: Vec<&str> = from_registry.map(|c| c["purl"].as_str().unwrap()).collect();
        assert_eq!(found, crates);
        // What is said to be needed is listed, once.
        let mut refs: Vec<&str> = components.iter().map(|c| c["bom-ref"].as_str().unwrap()).collect();
        refs.push(list["metadata"]["component"]["bom-ref"].as_str().unwrap());
        let n = refs.len();
        refs.sort_unstable();
        refs.dedup();
        assert_eq!(refs.len(), n);
        for needed in
            list["dependencies"].as_array().unwrap().iter().flat_map(|d| d["dependsOn"].as_array().unwrap())
        {
            assert!(refs.binary_search(&needed.as_str().unwrap()).is_ok(), "{needed}");
        }
    }

    #[test]
    fn packages_of_development_are_not_in_the_page() {
        let page = json!({ "packages": {
            "": { "name": "page" },
            "node_modules/three": { "version": "1.2.3", "integrity": "sha512-AAEC", "license": "MIT" },
            "node_modules/@a/b": { "version": "2.0.0", "integrity": "sha512-/w==", "license": "MIT" },
            "node_modules/esbuild": { "version": "0.1.0", "dev": true },
        } });
        let found = bundled(&page).unwrap();
        let purls: Vec<&str> = found.iter().map(|c| c["purl"].as_str().unwrap()).collect();
        assert_eq!(purls, ["pkg:npm/three@1.2.3", "pkg:npm/%40a/b@2.0.0"]);
        assert_eq!(found[0]["hashes"][0]["content"], "000102");
    }
}
