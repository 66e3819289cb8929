//! The book: the pages of `docs/` as one site with a search that needs no network.
//!
//! [`run`] copies `docs/` below the target folder, adds the pages that are generated (the options of every command,
//! from the program's own `--help`) and those of the top folder, and has mdBook make HTML of it. Before, every
//! relative link of every page is followed; after, every link of the HTML. [`run_blocks`] runs the `sh` blocks of every
//! page, page by page in an empty folder, and the commands of the table of README.md; blocks that only show a line are `console`, and those that need the Python
//! package are `sh python`.
//!
//! Pictures of a page are made by its own blocks: `pictures/PAGE/FILE` is the file of that path that they write, made
//! smaller. `book run` fails where they no longer write it, `book pictures` renews them.
//!
//! Limits: links to other sites are not asked for; mdBook is looked for below the target folder and on the path, and
//! where it is not there the book is not made, which is said.

use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The version that the book is made with.
const MDBOOK: &str = "0.5.4";

/// The first page of the project.
const README: &str = "README.md";

/// Pages of the top folder that the book holds too.
const TOP: [&str; 3] = ["ARCHITECTURE.md", "CONTRIBUTING.md", "CHANGELOG.md"];

/// Makes the book, or runs its command blocks.
pub fn run(words: &[&str]) -> Result<(), String> {
    match words {
        [] => make(),
        ["run", "--allow-missing", pages @ ..] => run_blocks(pages, false).map(|left_out| {
            println!("{left_out} blocks could not run here, which --allow-missing accepts");
        }),
        ["run", pages @ ..] => run_blocks(pages, false).and_then(none_left_out),
        ["json"] => crate::json::check(),
        ["axe"] => crate::page::ask_axe(&crate::target().join("book/html")),
        ["pictures", pages @ ..] => run_blocks(pages, true).and_then(none_left_out),
        ["install"] => {
            println!("installing mdBook {MDBOOK} below {}", crate::target().display());
            let mut command = Command::new("cargo");
            command.args(["install", "mdbook", "--version", MDBOOK, "--locked", "--debug"]);
            command.args(["--no-default-features", "--features", "search", "--root"]);
            crate::run(command.arg(crate::target().join("tools")))
        }
        _ => {
            Err("usage: cargo xtask book [install | axe | run [--allow-missing] [PAGE...] | pictures [PAGE...] | json]"
                .to_owned())
        }
    }
}

/// Blocks that could not run are a failure.
fn none_left_out(left_out: usize) -> Result<(), String> {
    match left_out {
        0 => Ok(()),
        n => Err(format!(
            "{n} blocks could not run: the Python package with Dask is missing below {}; `cargo xtask python` builds and \
             installs it, and `book run --allow-missing` goes without",
            crate::setup::venv().display()
        )),
    }
}

/// mdBook, if it is there.
pub fn mdbook() -> Option<PathBuf> {
    let own = crate::target().join("tools/bin/mdbook");
    let found = [own, PathBuf::from("mdbook")];
    found.into_iter().find(|p| Command::new(p).arg("--version").output().is_ok_and(|o| o.status.success()))
}

fn make() -> Result<(), String> {
    let broken = dead_links(&crate::root())?;
    if !broken.is_empty() {
        return Err(broken.join("\n       "));
    }
    let Some(mdbook) = mdbook() else {
        println!("NOT RUN: the book needs mdBook; `cargo xtask book install` builds it in a minute or two");
        return Ok(());
    };
    let folder = crate::target().join("book");
    let (source, html) = (folder.join("src"), folder.join("html"));
    let _ = fs::remove_dir_all(&folder);
    copy(&crate::root().join("docs"), &source)?;
    for page in TOP {
        let text = read(&crate::root().join(page))?.replace("](docs/", "](");
        write(&source.join(page), &text)?;
    }
    for page in pages(&source)? {
        let text = read(&page)?;
        let depth = page.strip_prefix(&source).map_or(0, |p| p.components().count() - 1);
        let up = "../".repeat(depth);
        // One folder higher than the page is the top of the book, where those pages lie now.
        let moved = TOP
            .iter()
            .fold(text.clone(), |t, top| t.replace(&format!("]({up}../{top}"), &format!("]({up}{top}")));
        if moved != text {
            write(&page, &moved)?;
        }
    }
    let program = crate::ci_program();
    write(&source.join("cli.md"), &options(&program)?)?;
    // The summary in the sources links to what is there; this page is made with the book.
    let summary = source.join("SUMMARY.md");
    let listed = read(&summary)?;
    let commands = "- [Commands](commands.md)\n";
    let with_options =
        listed.replacen(commands, &format!("{commands}- [Options of every command](cli.md)\n"), 1);
    if with_options == listed {
        return Err("docs/SUMMARY.md: there is no line of the page of commands".to_owned());
    }
    write(&summary, &with_options)?;
    let planner = crate::wasm::built_page();
    if planner.exists() {
        // The page is part of the site where it was built.
        let text = read(&source.join("try.md"))?;
        write(
            &source.join("try.md"),
            &text.replacen("\n\n", "\n\n**[Open the page](planner.html)**\n\n", 1),
        )?;
        fs::copy(&planner, source.join("planner.html")).map_err(|e| format!("{}: {e}", planner.display()))?;
    }
    let told = Command::new(mdbook).arg("build").arg(&source).arg("--dest-dir").arg(&html).output();
    let told = told.map_err(|e| format!("mdbook: {e}"))?;
    let said = String::from_utf8_lossy(&told.stderr).into_owned();
    if !told.status.success() || said.contains("ERROR") || said.contains("WARN") {
        return Err(format!("mdbook: {said}"));
    }
    // mdBook gives no title to the contents that readers without scripts see in a frame.
    let contents = html.join("toc.html");
    write(&contents, &read(&contents)?.replacen("<head>", "<head>\n<title>Table of contents</title>", 1))?;
    let (n, broken) = dead_links_of_html(&html)?;
    if !broken.is_empty() {
        return Err(broken.join("\n       "));
    }
    println!("{}: {n} pages, no dead link", html.join("index.html").display());
    Ok(())
}

/// The page with the help of every command.
fn options(program: &Path) -> Result<String, String> {
    let help = |words: &[&str]| crate::output(Command::new(program).args(words).env("COLUMNS", "110"));
    let top = help(&["--help"])?;
    let listed = top.lines().skip_while(|l| *l != "Commands:").skip(1).take_while(|l| !l.is_empty());
    let names: Vec<String> = listed.filter_map(|l| l.split_whitespace().next().map(str::to_owned)).collect();
    if names.is_empty() {
        return Err("grainpath --help lists no commands".to_owned());
    }
    let mut out = format!("# Options of every command\n\n```text\n{}\n```\n", top.trim_end());
    for name in names {
        let _ =
            write!(out, "\n## grainpath {name}\n\n```text\n{}\n```\n", help(&[&name, "--help"])?.trim_end());
    }
    Ok(out)
}

/// Relative links of the pages that lead nowhere.
fn dead_links(root: &Path) -> Result<Vec<String>, String> {
    let mut broken = Vec::new();
    let mut all = pages(&root.join("docs"))?;
    all.push(root.join(README));
    all.extend(TOP.iter().map(|p| root.join(p)));
    for page in all {
        let folder = page.parent().unwrap_or(root).to_owned();
        for link in links(&read(&page)?) {
            let path = link.split('#').next().unwrap_or_default();
            if !path.is_empty() && !folder.join(path).exists() {
                broken.push(format!("{} links to {link}, which is not there", page.display()));
            }
        }
    }
    Ok(broken)
}

/// Targets of the links and pictures of a page outside code, without addresses of other sites.
fn links(page: &str) -> Vec<String> {
    let mut out = Vec::new();
    let mut in_code = false;
    for line in page.lines() {
        if line.trim_start().starts_with("```") {
            in_code = !in_code;
        }
        // Odd pieces between back-quotes are code.
        let text: Vec<&str> = line.split('`').collect();
        let text =
            text.iter().enumerate().map(|(i, t)| if i % 2 == 0 { *t } else { "code" }).collect::<String>();
        for piece in text.split("](").skip(1).filter(|_| !in_code) {
            let target = piece.split([')', ' ']).next().unwrap_or_default();
            if !target.contains("://") && !target.starts_with("mailto:") {
                out.push(target.to_owned());
            }
        }
    }
    out
}

/// The number of HTML files, and their links that lead nowhere: files that are not there, and places that no page has.
fn dead_links_of_html(folder: &Path) -> Result<(usize, Vec<String>), String> {
    let mut broken = Vec::new();
    let all: Vec<PathBuf> =
        files(folder)?.into_iter().filter(|p| p.extension().is_some_and(|e| e == "html")).collect();
    for page in &all {
        // This page is shown for any address, so its links start at the top.
        if page.ends_with("404.html") || page.ends_with("print.html") || page.ends_with("toc.html") {
            continue;
        }
        let text = read(page)?;
        let parts = ["href=\"", "src=\""].into_iter().flat_map(|key| text.split(key).skip(1));
        for link in parts.filter_map(|t| t.split('"').next()) {
            if link.contains("://")
                || link.starts_with("data:")
                || link.starts_with("mailto:")
                || link.is_empty()
            {
                continue;
            }
            let (path, place) = link.split_once('#').unwrap_or((link, ""));
            let target =
                if path.is_empty() { page.clone() } else { page.parent().unwrap_or(folder).join(path) };
            if !target.exists() {
                broken.push(format!("{} links to {link}", page.display()));
                continue;
            }
            let is_page = !place.is_empty() && target.extension().is_some_and(|e| e == "html");
            if is_page && !read(&target)?.contains(&format!("id=\"{place}\"")) {
                broken.push(format!("{} links to {link}, a place that is not there", page.display()));
            }
        }
    }
    Ok((all.len(), broken))
}

/// Runs the `sh` blocks of every page, or of these; the first that fails ends it. `renew` copies the pictures that they
/// write to where the pages show them. The result is the number of blocks that could not run.
fn run_blocks(only: &[&str], renew: bool) -> Result<usize, String> {
    let docs = crate::root().join("docs");
    let program = crate::ci_program();
    let path = std::env::var("PATH").unwrap_or_default();
    // The wheel brings a program of the same name; the one that was built last comes first.
    let python = crate::setup::venv().join("bin");
    let path =
        format!("{}:{}:{path}", program.parent().unwrap_or(Path::new(".")).display(), python.display());
    let has_python = crate::setup::quiet(
        Command::new("python3").args(["-c", "import grainpath, dask, distributed"]).env("PATH", &path),
    );
    let (mut n, mut n_pictures, mut left_out) = (0, 0, 0);
    for page in pages(&docs)? {
        let name = page.strip_prefix(&docs).map_err(|e| e.to_string())?.display().to_string();
        let text = read(&page)?;
        let all = blocks(&text).map_err(|e| format!("docs/{name}: {e}"))?;
        let runnable: Vec<&str> =
            all.iter().filter(|b| has_python || !b.needs_python).map(|b| b.text.as_str()).collect();
        if all.is_empty() || !(only.is_empty() || only.contains(&name.as_str())) {
            continue;
        }
        let lacking = all.len() - runnable.len();
        if lacking > 0 {
            println!("NOT RUN: {lacking} blocks of docs/{name} need the Python package with Dask");
            left_out += lacking;
        }
        let slug = name.trim_end_matches(".md").replace('/', "-");
        let folder = crate::target().join("blocks").join(&slug);
        let _ = fs::remove_dir_all(&folder);
        fs::create_dir_all(&folder).map_err(|e| e.to_string())?;
        // Pages about the reader's own part name it part.stl; the example plate stands for it.
        let stands_for = |from: &str, to: &str| fs::copy(crate::root().join(from), folder.join(to)).map(drop);
        stands_for("examples/plate/plate.stl", "part.stl").map_err(|e| e.to_string())?;
        // Jobs of the gallery are named as from the top folder of a clone.
        let gallery = folder.join("docs/gallery");
        fs::create_dir_all(&gallery).map_err(|e| e.to_string())?;
        for file in files(&docs.join("gallery"))?.iter().filter(|f| f.parent() == Some(&docs.join("gallery")))
        {
            let is_input = file.extension().is_some_and(|e| e == "toml" || e == "svg");
            if let Some(name) = file.file_name().filter(|_| is_input) {
                fs::copy(file, gallery.join(name)).map_err(|e| format!("{}: {e}", file.display()))?;
            }
        }
        n += runnable.len();
        let script = format!("set -e\n{}", runnable.join("\n"));
        let mut command = Command::new("bash");
        command.args(["-c", &script]).current_dir(&folder).env("PATH", &path);
        crate::output(&mut command).map_err(|e| format!("docs/{name}: {e}"))?;
        for picture in made_pictures(&text, &slug) {
            let made = folder.join(&picture);
            if !made.exists() {
                return Err(format!("docs/{name} shows {picture}, which its blocks do not write"));
            }
            if renew {
                reduce(&made, &docs.join("pictures").join(&slug).join(&picture))?;
            }
            n_pictures += 1;
        }
        println!("docs/{name}: {} blocks", runnable.len());
    }
    if only.is_empty() || only.contains(&README) {
        n += run_readme(&path)?;
    }
    if n + left_out == 0 {
        return Err("no page with such a name has blocks to run".to_owned());
    }
    println!("{n} blocks ran and {left_out} did not; they write all {n_pictures} pictures of their pages");
    Ok(left_out)
}

/// Makes the files that stand for the reader's own in the table of README.md.
const STAND_INS: &str = "grainpath new woodgrain wood && cp wood/board.png board.png
grainpath new ct ct && cp ct/hub.tif scan.tif
grainpath new tree-support trees && cp trees/ball.stl figure.stl";

/// Runs the commands of the table of README.md, each as it stands there. Those of the studio wait for a browser and are
/// named instead.
fn run_readme(path: &str) -> Result<usize, String> {
    let folder = crate::target().join("blocks/README");
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).map_err(|e| e.to_string())?;
    let part = crate::root().join("examples/plate/plate.stl");
    fs::copy(&part, folder.join("part.stl")).map_err(|e| format!("{}: {e}", part.display()))?;
    let run = |script: &str| {
        let mut command = Command::new("bash");
        command.args(["-c", &format!("set -e\n{script}")]).current_dir(&folder).env("PATH", path);
        crate::output(&mut command).map_err(|e| format!("{README}: {script}: {e}"))
    };
    run(STAND_INS)?;
    let (shown, runnable): (Vec<String>, Vec<String>) =
        commands_of_tables(&read(&crate::root().join(README))?)
            .into_iter()
            .partition(|c| c.starts_with("grainpath studio"));
    for command in &shown {
        println!("NOT RUN: {README}: {command}: it waits for a browser");
    }
    for command in &runnable {
        run(command)?;
    }
    println!("{README}: {} commands of its table", runnable.len());
    match runnable.len() {
        0 => Err(format!("{README} has no table with commands of grainpath")),
        n => Ok(n),
    }
}

/// The commands of grainpath in the rows of tables.
fn commands_of_tables(page: &str) -> Vec<String> {
    let rows = page.lines().filter(|l| l.starts_with('|'));
    rows.flat_map(|row| row.split('`').skip(1).step_by(2))
        .filter(|code| code.starts_with("grainpath "))
        .map(str::to_owned)
        .collect()
}

/// A block of commands.
struct Block {
    text: String,
    /// Whether it needs the Python package.
    needs_python: bool,
}

/// The `sh` blocks of a page, those inside lists too. Commands under another name would never run, so they are refused.
fn blocks(page: &str) -> Result<Vec<Block>, String> {
    let mut out = Vec::new();
    let mut lines = page.lines();
    while let Some(line) = lines.next() {
        let indent = line.len() - line.trim_start().len();
        let Some(info) = line.trim_start().strip_prefix("```") else { continue };
        let inside = lines.by_ref().take_while(|l| l.trim() != "```");
        let inside: Vec<&str> = inside.map(|l| l.get(indent..).unwrap_or_default()).collect();
        match info.trim() {
            "sh" | "sh python" => {
                out.push(Block { text: inside.join("\n"), needs_python: info.trim() == "sh python" });
            }
            other if other.starts_with("sh") || other == "bash" || other == "zsh" => {
                return Err(format!(
                    "a block of {other:?} would never run; `sh` and `sh python` run, `console` is shown"
                ));
            }
            _ => {}
        }
    }
    Ok(out)
}

/// Paths, in the folder of its blocks, of the pictures that a page shows from `pictures/SLUG`.
fn made_pictures(page: &str, slug: &str) -> Vec<String> {
    let start = format!("pictures/{slug}/");
    links(page).iter().filter_map(|l| l.split_once(&start).map(|(_, path)| path.to_owned())).collect()
}

/// Greatest width of a picture of a page, pixels. Source: `--content-max-width` of mdBook, 750 px, and a fifth more for fine screens.
const WIDEST_PX: usize = 900;

/// Most bytes of a picture of a page. Source: chosen so that a page with six pictures loads in less than half a megabyte.
const MOST_PICTURE_BYTES: usize = 60_000;

/// Most colours of a picture of a page. Measured: with 64 the stress of a bracket takes 68 instead of 279 kB at 800 x 704 pixels;
/// smooth colours show faint steps.
const MOST_COLOURS: usize = 64;

/// The pixels of a picture: bytes each, row by row.
struct Pixels {
    width: usize,
    color: png::ColorType,
    bytes: Vec<u8>,
}

/// Writes a picture smaller by a whole number, each pixel the mean of a square of pixels, with few colours. The number is the
/// least that keeps both limits. Drawings in SVG are copied.
fn reduce(from: &Path, to: &Path) -> Result<(), String> {
    fs::create_dir_all(to.parent().unwrap_or(to)).map_err(|e| e.to_string())?;
    if from.extension().is_some_and(|e| e == "svg") {
        return fs::copy(from, to).map(drop).map_err(|e| format!("{}: {e}", from.display()));
    }
    let wrong = |e: png::DecodingError| format!("{}: {e}", from.display());
    let file = fs::File::open(from).map_err(|e| format!("{}: {e}", from.display()))?;
    let mut decoder = png::Decoder::new(std::io::BufReader::new(file));
    decoder.set_transformations(png::Transformations::EXPAND | png::Transformations::STRIP_16);
    let mut reader = decoder.read_info().map_err(wrong)?;
    let mut bytes = vec![0; reader.output_buffer_size().ok_or("a picture too large")?];
    let info = reader.next_frame(&mut bytes).map_err(wrong)?;
    let picture = Pixels { width: info.width as usize, color: info.color_type, bytes };
    let least = picture.width.div_ceil(WIDEST_PX).max(1);
    for by in least.. {
        let made = encoded(&smaller(&picture, by))?;
        if made.len() <= MOST_PICTURE_BYTES || by > least + 2 {
            return fs::write(to, made).map_err(|e| format!("{}: {e}", to.display()));
        }
    }
    Ok(())
}

/// A picture in which each pixel is the mean of `by` times `by` pixels.
fn smaller(picture: &Pixels, by: usize) -> Pixels {
    let (n, w) = (picture.color.samples(), picture.width);
    let h = picture.bytes.len() / (n * w);
    let (small_w, small_h) = (w / by, h / by);
    let mut bytes = Vec::with_capacity(small_w * small_h * n);
    for y in 0..small_h {
        for x in 0..small_w {
            for c in 0..n {
                let square = (0..by * by).map(|i| ((y * by + i / by) * w + x * by + i % by) * n + c);
                let sum: usize = square.map(|i| usize::from(picture.bytes[i])).sum();
                bytes.push(u8::try_from(sum / (by * by)).unwrap_or(u8::MAX));
            }
        }
    }
    Pixels { width: small_w, color: picture.color, bytes }
}

/// A picture as a PNG file; one with colours and without transparent pixels has a palette.
fn encoded(picture: &Pixels) -> Result<Vec<u8>, String> {
    let n = picture.color.samples();
    let height = picture.bytes.len() / (n * picture.width);
    let side = |n: usize| u32::try_from(n).map_err(|e| e.to_string());
    let mut out = Vec::new();
    let mut encoder = png::Encoder::new(&mut out, side(picture.width)?, side(height)?);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::High);
    let is_opaque = n == 3 || n == 4 && picture.bytes.chunks_exact(4).all(|p| p[3] == u8::MAX);
    let bytes = if is_opaque {
        let pixels: Vec<[u8; 3]> = picture.bytes.chunks_exact(n).map(|p| [p[0], p[1], p[2]]).collect();
        let (palette, indices) = palette(&pixels);
        encoder.set_color(png::ColorType::Indexed);
        encoder.set_palette(palette.concat());
        indices
    } else {
        encoder.set_color(picture.color);
        picture.bytes.clone()
    };
    let mut writer = encoder.write_header().map_err(|e| e.to_string())?;
    writer.write_image_data(&bytes).map_err(|e| e.to_string())?;
    writer.finish().map_err(|e| e.to_string())?;
    Ok(out)
}

/// Few colours for a picture, and which of them each pixel takes: the box of colours with the widest side is cut at the
/// median of its pixels until there are enough (median cut), and a pixel takes the mean of its box.
fn palette(pixels: &[[u8; 3]]) -> (Vec<[u8; 3]>, Vec<u8>) {
    let widest = |pixels: &[[u8; 3]], cell: &[usize]| {
        let side = |c: usize| {
            let values = cell.iter().map(|i| pixels[*i][c]);
            values.clone().max().unwrap_or(0) - values.min().unwrap_or(0)
        };
        (0..3).map(|c| (side(c), c)).max().unwrap_or((0, 0))
    };
    let mut cells =
        vec![(widest(pixels, &(0..pixels.len()).collect::<Vec<_>>()), (0..pixels.len()).collect())];
    while cells.len() < MOST_COLOURS {
        let Some(at) = (0..cells.len()).max_by_key(|k| cells[*k].0.0).filter(|k| cells[*k].0.0 > 0) else {
            break;
        };
        let ((_, c), mut cell): (_, Vec<usize>) = cells.swap_remove(at);
        cell.sort_by_key(|i| (pixels[*i][c], *i));
        let middle = pixels[cell[cell.len() / 2]][c].max(pixels[cell[0]][c] + 1);
        let rest = cell.split_off(cell.partition_point(|i| pixels[*i][c] < middle));
        cells.push((widest(pixels, &cell), cell));
        cells.push((widest(pixels, &rest), rest));
    }
    let mut indices = vec![0; pixels.len()];
    let mut colours = Vec::with_capacity(cells.len());
    for (k, (_, cell)) in cells.iter().enumerate() {
        let mean =
            |c: usize| cell.iter().map(|i| usize::from(pixels[*i][c])).sum::<usize>() / cell.len().max(1);
        colours.push([0, 1, 2].map(|c| u8::try_from(mean(c)).unwrap_or(u8::MAX)));
        cell.iter().for_each(|i| indices[*i] = u8::try_from(k).unwrap_or(0));
    }
    (colours, indices)
}

pub fn pages(folder: &Path) -> Result<Vec<PathBuf>, String> {
    Ok(files(folder)?.into_iter().filter(|p| p.extension().is_some_and(|e| e == "md")).collect())
}

/// All files below a folder, sorted.
pub fn files(folder: &Path) -> Result<Vec<PathBuf>, String> {
    let mut all = Vec::new();
    for entry in fs::read_dir(folder).map_err(|e| format!("{}: {e}", folder.display()))?.flatten() {
        let path = entry.path();
        if path.is_dir() { all.extend(files(&path)?) } else { all.push(path) }
    }
    all.sort();
    Ok(all)
}

fn copy(from: &Path, to: &Path) -> Result<(), String> {
    for file in files(from)? {
        let target = to.join(file.strip_prefix(from).map_err(|e| e.to_string())?);
        fs::create_dir_all(target.parent().unwrap_or(to)).map_err(|e| e.to_string())?;
        fs::copy(&file, &target).map_err(|e| format!("{}: {e}", file.display()))?;
    }
    Ok(())
}

pub fn read(path: &Path) -> Result<String, String> {
    fs::read_to_string(path).map_err(|e| format!("{}: {e}", path.display()))
}

fn write(path: &Path, text: &str) -> Result<(), String> {
    fs::write(path, text).map_err(|e| format!("{}: {e}", path.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn links_are_found_outside_code() {
        let page = "See [a](b.md#c) and ![p](d/e.png), `f[1](2)`, [site](https://example.org).\n```sh\necho [x](y)\n```\n[z](w.md)";
        assert_eq!(links(page), ["b.md#c", "d/e.png", "w.md"]);
    }

    #[test]
    fn blocks_that_only_show_a_line_are_not_run() {
        let page = "Text\n```sh\ngrainpath new plate\ncd plate\n```\n\n```console\nsudo rm\n```\n\n1. In a list\n   ```sh python\n   ls\n     x\n\n   ```\n";
        let found: Vec<(String, bool)> =
            blocks(page).unwrap().into_iter().map(|b| (b.text, b.needs_python)).collect();
        assert_eq!(
            found,
            [("grainpath new plate\ncd plate".to_owned(), false), ("ls\n  x\n".to_owned(), true)]
        );
        assert!(blocks("```bash\nls\n```\n").is_err() && blocks("```sh dask\nls\n```\n").is_err());
    }

    #[test]
    fn commands_of_a_table_are_found_in_its_rows() {
        let page = "| a | type |\n|---|---|\n| b | `x`, `grainpath slice part.stl`, then `grainpath help` |\n| c | `ls` |\n\n`grainpath run a.toml`\n";
        assert_eq!(commands_of_tables(page), ["grainpath slice part.stl", "grainpath help"]);
    }

    #[test]
    fn pictures_of_a_page_are_files_of_its_blocks() {
        let page = "![a](../pictures/how-to-loads/out/loads.png) and ![b](../pictures/other/x.png)";
        assert_eq!(made_pictures(page, "how-to-loads"), ["out/loads.png"]);
    }

    #[test]
    fn a_palette_keeps_few_colours_and_takes_means_of_many() {
        let few = [[1, 2, 3], [200, 0, 0], [1, 2, 3], [0, 0, 255]];
        let (colours, indices) = palette(&few);
        assert_eq!(colours.len(), 3);
        assert!(few.iter().zip(&indices).all(|(p, i)| colours[usize::from(*i)] == *p));
        let many: Vec<[u8; 3]> = (0..=255).map(|v| [v, v, v]).collect();
        let (colours, indices) = palette(&many);
        assert_eq!(colours.len(), MOST_COLOURS);
        assert!(many.iter().zip(&indices).all(|(p, i)| colours[usize::from(*i)][0].abs_diff(p[0]) <= 4));
    }

    #[test]
    fn a_picture_is_made_smaller_by_means_of_squares() {
        let folder = crate::target().join("failures");
        fs::create_dir_all(&folder).unwrap();
        let (from, to) = (folder.join("large.png"), folder.join("small.png"));
        let mut encoder = png::Encoder::new(fs::File::create(&from).unwrap(), 1800, 4);
        encoder.set_color(png::ColorType::Grayscale);
        encoder.set_depth(png::BitDepth::Eight);
        let columns: Vec<u8> = (0..1800).map(|x| if x % 2 == 0 { 10 } else { 30 }).collect();
        encoder.write_header().unwrap().write_image_data(&columns.repeat(4)).unwrap();
        reduce(&from, &to).unwrap();
        let file = std::io::BufReader::new(fs::File::open(&to).unwrap());
        let mut reader = png::Decoder::new(file).read_info().unwrap();
        assert_eq!((reader.info().width, reader.info().height), (900, 2));
        let mut pixels = vec![0; 1800];
        reader.next_frame(&mut pixels).unwrap();
        assert!(pixels.iter().all(|p| *p == 20));
    }
}
