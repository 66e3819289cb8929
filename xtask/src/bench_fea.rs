//! Meshing and solving of a solid beside gmsh and CalculiX, in one run.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::process::Command;

use crate::bench::{Cost, timed_output};

/// Cases: about as many unknowns each, gmsh's largest element and our element size, mm; ours is halved at
/// thin walls. The bracket's end faces are held and pulled.
const CASES: [(&str, &str, &str); 2] = [("300 000", "2.55", "3.7"), ("1 000 000", "1.55", "2.3")];

/// Bracket on 2 threads. The peers are gmsh (straight-sided second order) and CalculiX with its iterative
/// solver, which is the faster one here; ours solves to a residual of 1e-8.
pub fn run(cases: &[&str]) -> Result<(), String> {
    let root = crate::root();
    let data = crate::setup::data()?;
    crate::setup::fea()?;
    crate::cargo(&["build", "--release", "-p", "grainpath-fea", "--example", "solve_stl"])?;
    let folder = root.join("target/bench/fea");
    fs::create_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    println!(
        "\n| unknowns | program | dofs | wall s | peak MiB | largest displacement mm |\n|---|---|---|---|---|---|"
    );
    for (name, gmsh_size, our_size) in CASES {
        if !cases.is_empty() && !cases.iter().any(|c| name.replace(' ', "") == **c) {
            continue;
        }
        let mut ours = Command::new(crate::built("examples/solve_stl"));
        ours.arg(data.join("meshes/featuretype_inch.stl")).args(["25.4", our_size]);
        let (cost, text) = timed_output(&mut ours, &folder)?;
        let (dofs, moved) = (after(&text, " elements, "), after(&text, "largest displacement "));
        row(name, "grainpath, mesh and solve", dofs, &cost, Some(moved));

        let mesh = folder.join("gmsh.inp");
        let mut gmsh = Command::new("gmsh");
        // Straight sides, as our mesher makes them.
        gmsh.arg(data.join("fea/bracket.step"))
            .args(["-3", "-order", "2", "-setnumber", "Mesh.SecondOrderLinear", "1", "-nt", "2"])
            .args(["-setnumber", "Mesh.SaveAll", "1", "-clmax", gmsh_size, "-format", "inp", "-o"])
            .arg(&mesh);
        let (meshing, _) = timed_output(&mut gmsh, &folder)?;
        let dofs = deck(&mesh, &folder.join("deck.inp"))?;
        row(name, "gmsh", dofs, &meshing, None);
        let mut ccx = Command::new("ccx");
        ccx.arg("deck").current_dir(&folder).env("OMP_NUM_THREADS", "2");
        let (solving, _) = timed_output(&mut ccx, &folder)?;
        let moved = largest_displacement(&folder.join("deck.frd"))?;
        row(name, "CalculiX", dofs, &solving, Some(moved));
        let peer = meshing.wall_s + solving.wall_s;
        println!(
            "| {name} | **theirs / ours** | | **{:.1}** | **{:.1}** | |",
            peer / cost.wall_s,
            solving.peak_mib.max(meshing.peak_mib) / cost.peak_mib
        );
    }
    Ok(())
}

/// Prints what a program cost; `moved` is the largest displacement, mm, of one that solves.
fn row(name: &str, program: &str, dofs: f64, cost: &Cost, moved: Option<f64>) {
    let moved = moved.map_or_else(|| "-".to_owned(), |mm| format!("{mm:.5}"));
    println!("| {name} | {program} | {dofs:.0} | {:.2} | {:.0} | {moved} |", cost.wall_s, cost.peak_mib);
}

fn after(text: &str, mark: &str) -> f64 {
    let rest = text.split(mark).nth(1).unwrap_or_default();
    let number: String = rest.chars().take_while(|c| c.is_ascii_digit() || *c == '.').collect();
    number.parse().unwrap_or(f64::NAN)
}

/// Writes a deck over gmsh's mesh: the face at least x is held, 500 N act downwards on the face at
/// greatest x. Returns the number of unknowns.
fn deck(mesh: &Path, deck: &Path) -> Result<f64, String> {
    let text = fs::read_to_string(mesh).map_err(|e| format!("{}: {e}", mesh.display()))?;
    let (mut nodes, mut elements, mut tets) = (BTreeMap::new(), String::new(), Vec::new());
    let mut used: Vec<u64> = Vec::new();
    let mut section = String::new();
    for line in text.lines() {
        if line.starts_with('*') {
            section = line.to_uppercase();
        } else if section.starts_with("*NODE") {
            let words: Vec<&str> = line.split(',').map(str::trim).collect();
            let number = |i: usize| words.get(i).and_then(|w| w.parse::<f64>().ok());
            let (Some(id), Some(x)) = (number(0), number(1)) else { continue };
            nodes.insert(id as u64, (x, words[1..].join(",")));
        } else if section.contains("C3D10") {
            elements.push_str(line);
            elements.push('\n');
            let tet: Vec<u64> = line.split(',').skip(1).filter_map(|w| w.trim().parse().ok()).collect();
            used.extend(&tet);
            tets.push(tet);
        }
    }
    used.sort_unstable();
    used.dedup();
    // gmsh saves nodes of the geometry that no element uses; each would be an unknown without stiffness.
    nodes.retain(|id, _| used.binary_search(id).is_ok());
    let x = || nodes.values().map(|n| n.0);
    let (low, high) = (x().fold(f64::INFINITY, f64::min), x().fold(f64::NEG_INFINITY, f64::max));
    let at = |x: f64| nodes.iter().filter(move |n| (n.1.0 - x).abs() < 1e-6).map(|n| n.0);
    let mut out = String::from("*NODE\n");
    let put =
        |out: &mut String, line: std::fmt::Arguments<'_>| writeln!(out, "{line}").map_err(|e| e.to_string());
    for (id, (_, place)) in &nodes {
        put(&mut out, format_args!("{id},{place}"))?;
    }
    out.push_str("*ELEMENT,TYPE=C3D10,ELSET=ALL\n");
    out.push_str(&elements);
    out.push_str(
        "*MATERIAL,NAME=M\n*ELASTIC\n210000,0.3\n*SOLID SECTION,ELSET=ALL,MATERIAL=M\n*NSET,NSET=FIX\n",
    );
    for id in at(low) {
        put(&mut out, format_args!("{id},"))?;
    }
    out.push_str("*BOUNDARY\nFIX,1,3\n*STEP\n*STATIC,SOLVER=ITERATIVE CHOLESKY\n*CLOAD\n");
    // Source: the shape functions of a straight triangle of second order: an even pressure puts a third
    // of its force on each middle node and nothing on the corners.
    let place = |id: u64| -> Option<[f64; 3]> {
        let (_, text) = nodes.get(&id)?;
        let p: Vec<f64> = text.split(',').filter_map(|w| w.parse().ok()).collect();
        p.try_into().ok()
    };
    let (mut shares, mut total) = (BTreeMap::<u64, f64>::new(), 0.0);
    for tet in tets.iter().filter(|t| t.len() == 10) {
        for [a, b, c, ab, bc, ca] in
            // Faces in the numbering of C3D10: three corners, then the middles between them.
            [[0, 1, 2, 4, 5, 6], [0, 3, 1, 7, 8, 4], [1, 3, 2, 8, 9, 5], [2, 3, 0, 9, 7, 6]]
        {
            let (Some(a), Some(b), Some(c)) = (place(tet[a]), place(tet[b]), place(tet[c])) else { continue };
            if [a, b, c].iter().all(|p| (p[0] - high).abs() < 1e-6) {
                let area = 0.5 * ((b[1] - a[1]) * (c[2] - a[2]) - (b[2] - a[2]) * (c[1] - a[1])).abs();
                total += area;
                for m in [ab, bc, ca] {
                    *shares.entry(tet[m]).or_default() += area / 3.0;
                }
            }
        }
    }
    for (id, share) in shares {
        put(&mut out, format_args!("{id},3,{}", -500.0 * share / total))?;
    }
    out.push_str("*NODE FILE\nU\n*EL FILE\nS\n*END STEP\n");
    fs::write(deck, out).map_err(|e| format!("{}: {e}", deck.display()))?;
    Ok(3.0 * nodes.len() as f64)
}

/// The largest displacement in a result of CalculiX.
fn largest_displacement(frd: &Path) -> Result<f64, String> {
    let text = fs::read_to_string(frd).map_err(|e| format!("{}: {e}", frd.display()))?;
    let (mut inside, mut most) = (false, 0.0f64);
    for line in text.lines() {
        // Source: the FRD format of CalculiX: -4 starts a data set and names it, -1 starts a node's
        // values in columns of 12.
        if line.starts_with(" -4") {
            inside = line.contains("DISP");
        } else if inside && line.starts_with(" -1") {
            let part =
                |i: usize| line.get(13 + 12 * i..25 + 12 * i).and_then(|w| w.trim().parse::<f64>().ok());
            let squares = (0..3).filter_map(part).map(|v| v * v).sum::<f64>();
            most = most.max(squares.sqrt());
        }
    }
    Ok(most)
}
