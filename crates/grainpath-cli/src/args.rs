//! Commands of the program with their arguments and help texts.

use std::path::PathBuf;

use clap::{Parser, Subcommand};
use grainpath_core::Warning;

use crate::Failure;

/// Toolpaths for 3D printing that follow the load.
#[derive(Debug, Parser)]
#[command(
    name = "grainpath",
    version,
    about = "Toolpaths for 3D printing that follow the load",
    after_help = "Start with `grainpath slice part.stl`, or with `grainpath new plate` and `grainpath run plate/job.toml`.\n\
                  `grainpath COMMAND --help` shows examples of each command.",
    disable_help_subcommand = true
)]
pub(crate) struct Args {
    /// The command to run.
    #[command(subcommand)]
    pub command: Command,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Run a job file: slice, plan, write G-code, pictures and report
    #[command(
        after_help = "Examples:\n  grainpath run bracket.toml\n  grainpath run bracket.toml --set fill.density=0.4 --out trial --json"
    )]
    Run(RunArguments),
    /// Slice a mesh, a drawing, a scan or a photograph with default settings, without a job file
    #[command(
        after_help = "Examples:\n  grainpath slice part.stl\n  grainpath slice part.stl --hold f:03a06 --load f:83a02=200,-100,0\n  grainpath slice plate.svg --set shape.thickness_mm=4 -o plate.gcode"
    )]
    Slice(Slice),
    /// Write a commented example job with its input
    #[command(
        after_help = "Examples:\n  grainpath new plate\n  grainpath new stress-lines bars\n  grainpath new plate --printer prusa-mk3s --material petg"
    )]
    New(New),
    /// Grow supports for a mesh and write them as a separate mesh
    #[command(
        after_help = "Examples:\n  grainpath support statue.stl\n  grainpath support statue.stl -o both.3mf --with-model --preview steps"
    )]
    Support(Support),
    /// Write a calibration piece, for example for the critical overhang angle, or a standard test piece
    #[command(
        after_help = "Examples:\n  grainpath specimen\n  grainpath specimen critical-angle -o angle.stl"
    )]
    Specimen(Specimen),
    /// Describe a mesh, an image, a CT scan, a finite-element result or a G-code file, and list its defects
    #[command(
        after_help = "Examples:\n  grainpath inspect part.stl\n  grainpath inspect scan.nrrd --sheet slices.png"
    )]
    Inspect(Inspect),
    /// Compute the load at which the part of a job or of a G-code file breaks
    #[command(
        after_help = "Examples:\n  grainpath strength bracket.toml --preview damage\n  grainpath strength other-slicer.gcode --job bracket.toml --json"
    )]
    Strength(Strength),
    /// Compare the strength of several jobs or G-code files of one part
    #[command(
        after_help = "Examples:\n  grainpath compare along.toml across.toml --same-mass\n  grainpath compare ours.gcode theirs.gcode --job bracket.toml"
    )]
    Compare(Compare),
    /// Rank the stable poses of a job's part by the loads that it carries in them
    #[command(
        after_help = "Examples:\n  grainpath orient bracket.toml\n  grainpath orient bracket.toml --image poses.png --write"
    )]
    Orient(Orient),
    /// Draw a layer of a G-code file
    #[command(
        after_help = "Examples:\n  grainpath render part.gcode --layer 20 -o layer.svg\n  grainpath render part.gcode --part --size 2000"
    )]
    Render(Render),
    /// Write a sheet of corner markers to photograph a board on, as SVG or PDF
    #[command(
        after_help = "Examples:\n  grainpath markers 200 150\n  grainpath markers 200 150 -o sheet.pdf"
    )]
    Markers(Markers),
    /// Print the JSON Schema of job files
    #[command(after_help = "Examples:\n  grainpath schema > job.schema.json\n  grainpath schema --markdown")]
    Schema(Schema),
    /// List the profiles that come with grainpath, or print one
    #[command(
        after_help = "Examples:\n  grainpath profiles\n  grainpath profiles prusa-mk3s > my-printer.toml"
    )]
    Profiles(Profiles),
    /// Report what grainpath finds on this machine: version, cores, memory, folders, other programs
    #[command(after_help = "Examples:\n  grainpath doctor\n  grainpath doctor --json")]
    Doctor(Doctor),
    /// Print the licences of grainpath and of every library in it
    #[command(after_help = "Examples:\n  grainpath licences\n  grainpath licences | less")]
    Licences(Licences),
    /// Print the completion script for a shell
    #[command(
        after_help = "Examples:\n  grainpath completions bash > grainpath.bash && . ./grainpath.bash\n  grainpath completions zsh > _grainpath    # into a folder of $fpath"
    )]
    Completions(Completions),
    /// Write a manual page for each command
    #[command(
        after_help = "Examples:\n  grainpath man ~/.local/share/man/man1\n  grainpath man . && man ./grainpath-run.1"
    )]
    Man(Man),
    /// Open the studio: the web application on this computer
    #[cfg(feature = "studio")]
    #[command(
        after_help = "Examples:\n  grainpath studio part.gcode\n  grainpath studio bracket.stl --root ~/models --no-open"
    )]
    Studio(Studio),
}

impl Command {
    /// Whether the command serves until a signal, which it waits for itself.
    pub(crate) fn serves(&self) -> bool {
        match self {
            #[cfg(feature = "studio")]
            Self::Studio(_) => true,
            _ => false,
        }
    }

    /// Whether the user asked for JSON output.
    pub(crate) fn json(&self) -> bool {
        match self {
            Self::Run(a) => a.common.json,
            Self::Slice(a) => a.common.json,
            Self::Support(a) => a.common.json,
            Self::Inspect(a) => a.json,
            Self::Profiles(a) => a.json,
            Self::Strength(a) => a.common.json,
            Self::Compare(a) => a.common.json,
            Self::Orient(a) => a.common.json,
            #[cfg(feature = "studio")]
            Self::Studio(_) => false,
            Self::Doctor(a) => a.json,
            Self::New(_)
            | Self::Specimen(_)
            | Self::Render(_)
            | Self::Markers(_)
            | Self::Schema(_)
            | Self::Licences(_)
            | Self::Completions(_)
            | Self::Man(_) => false,
        }
    }
}

/// Options shared by all commands that take a job.
#[derive(Debug, clap::Args)]
pub(crate) struct Common {
    /// Override a setting of the job file
    #[arg(long = "set", value_name = "SECTION.KEY=VALUE")]
    pub sets: Vec<String>,
    /// Number of threads; the result does not depend on it
    #[arg(long, value_name = "N")]
    pub threads: Option<usize>,
    /// Print the report as one JSON object
    #[arg(long)]
    pub json: bool,
    /// Exit with code 4 on any warning; a warning before the outputs are written also stops them from being written
    #[arg(long)]
    pub strict: bool,
}

impl Common {
    /// Under `--strict`, refuses these warnings; `written` says whether the outputs exist.
    ///
    /// # Errors
    /// [`Failure`] with the warnings, if there are any.
    pub(crate) fn refuse(&self, warnings: &[Warning], written: bool) -> Result<(), Failure> {
        if self.strict && !warnings.is_empty() {
            Err(Failure::strict(warnings.to_vec(), written))
        } else {
            Ok(())
        }
    }
}

/// `grainpath run`
#[derive(Debug, clap::Args)]
pub(crate) struct RunArguments {
    /// Job file, or with --scheduler a folder of jobs
    pub job: PathBuf,
    /// Write outputs here instead of beside the job file
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Run all jobs of a folder on the workers of this Dask scheduler, through the Python package; `local` starts
    /// workers on this computer
    #[arg(long, value_name = "ADDRESS", conflicts_with_all = ["check", "strict"])]
    pub scheduler: Option<String>,
    /// Only solve the loads: report and draw which nodes the fixtures and loads act on, and write no G-code
    #[arg(long)]
    pub check: bool,
    #[command(flatten)]
    pub common: Common,
}

/// `grainpath slice`
#[derive(Debug, clap::Args)]
pub(crate) struct Slice {
    /// Mesh (STL, OBJ, PLY, OFF, 3MF), drawing (SVG, DXF), scan or photograph
    pub model: PathBuf,
    /// G-code file [default: the model's name with .gcode]
    #[arg(short, long, value_name = "FILE.gcode")]
    pub output: Option<PathBuf>,
    /// Face that is held, by its name from `grainpath inspect --faces`; give it once for each face. Needs --load
    #[arg(long, value_name = "FACE", requires = "loads")]
    pub hold: Vec<String>,
    /// Face that is loaded, and the force on it in N; give it once for each face. Beads then follow the stress. Needs
    /// --hold
    #[arg(
        long = "load",
        id = "loads",
        value_name = "FACE=X,Y,Z",
        requires = "hold",
        allow_hyphen_values = true
    )]
    pub loads: Vec<String>,
    #[command(flatten)]
    pub common: Common,
}

/// `grainpath support`
#[derive(Debug, clap::Args)]
pub(crate) struct Support {
    /// Mesh: STL, OBJ, PLY, OFF or 3MF
    pub model: PathBuf,
    /// File to write, .stl or .3mf [default: the mesh's name with _support.stl]
    #[arg(short, long, value_name = "FILE.stl")]
    pub output: Option<PathBuf>,
    /// Write the model into the same file as its supports
    #[arg(long)]
    pub with_model: bool,
    /// Folder for pictures of the steps: overhangs, contacts, trees
    #[arg(long, value_name = "DIR")]
    pub preview: Option<PathBuf>,
    #[command(flatten)]
    pub common: Common,
}

/// `grainpath specimen`
#[derive(Debug, clap::Args)]
pub(crate) struct Specimen {
    /// Name of the specimen; without a name, all specimens are listed
    pub name: Option<String>,
    /// File to write [default: the specimen's name with .stl]
    #[arg(short, long, value_name = "FILE.stl")]
    pub output: Option<PathBuf>,
}

/// `grainpath new`
#[derive(Debug, clap::Args)]
pub(crate) struct New {
    /// Which example: plate, stress-lines, field, ct, woodgrain, tree-support or continuous
    pub preset: String,
    /// Folder to write to [default: the example's name]
    pub dir: Option<PathBuf>,
    /// Columns and rows of the scan that `ct` writes [default: 256]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(64..=1024))]
    pub pixels: Option<u32>,
    /// Overwrite existing files
    #[arg(long)]
    pub force: bool,
    /// Printer of the jobs, a name from `grainpath profiles`; without it you are asked in a terminal
    #[arg(long, value_name = "PROFILE")]
    pub printer: Option<String>,
    /// Material of the jobs, given like --printer
    #[arg(long, value_name = "PROFILE")]
    pub material: Option<String>,
    /// Ask nothing: without --printer or --material, the example keeps its own profile
    #[arg(long)]
    pub yes: bool,
}

/// `grainpath inspect`
#[derive(Debug, clap::Args)]
pub(crate) struct Inspect {
    /// Mesh, image, finite-element result, G-code, or a scan: a folder of slices or a volume file
    pub file: PathBuf,
    /// Write a contact sheet of a scan here
    #[arg(long, value_name = "FILE.png")]
    pub sheet: Option<PathBuf>,
    /// List the faces of a mesh or of a drawing with its thickness: planes, cylinders, cones and spheres, with names for
    /// fixtures and loads
    #[arg(long)]
    pub faces: bool,
    /// Write a picture here: with --faces the faces, numbered as in the list; for a scan its histogram with
    /// the thresholds; for a photograph its grain
    #[arg(long, value_name = "FILE.png")]
    pub image: Option<PathBuf>,
    /// File of true dimensions to compare a G-code file with, in the format of shape.ct.truth
    #[arg(long, value_name = "FILE.toml")]
    pub truth: Option<PathBuf>,
    /// For G-code: a setting of the printer whose limits and filament the time and the volume are counted with; for the
    /// faces of a drawing its thickness, as shape.thickness_mm=N
    #[arg(long = "set", value_name = "SECTION.KEY=VALUE", conflicts_with = "sheet")]
    pub sets: Vec<String>,
    /// Columns, rows and slices of raw data
    #[arg(long, value_name = "X,Y,Z", value_delimiter = ',')]
    pub size: Option<Vec<usize>>,
    /// Number type of a voxel in raw data
    #[arg(long, default_value = "u8", value_parser = grainpath_core::slices::SampleType::NAMES)]
    pub sample: String,
    /// Print the answer as one JSON object
    #[arg(long)]
    pub json: bool,
}

/// `grainpath strength`
#[derive(Debug, clap::Args)]
pub(crate) struct Strength {
    /// Job file, or G-code of any slicer
    pub input: PathBuf,
    /// The job whose part, loads and material belong to the G-code
    #[arg(long, value_name = "JOB.toml")]
    pub job: Option<PathBuf>,
    /// Folder for pictures: damage.png, index.png, curve.svg
    #[arg(long, value_name = "DIR")]
    pub preview: Option<PathBuf>,
    /// Write the plate before anything breaks as a CalculiX deck: a stiffness for each cell, fixtures and the load
    #[arg(long, value_name = "FILE.inp")]
    pub deck: Option<PathBuf>,
    #[command(flatten)]
    pub common: Common,
}

/// `grainpath compare`
#[derive(Debug, clap::Args)]
pub(crate) struct Compare {
    /// Job files, or G-code files together with --job; each peak load is divided by that of the first file
    #[arg(required = true, num_args = 1..)]
    pub inputs: Vec<PathBuf>,
    /// The job whose part, loads and material belong to G-code files
    #[arg(long, value_name = "JOB.toml")]
    pub job: Option<PathBuf>,
    /// Adjust the fill density of every job so that all parts have the mass of the first
    #[arg(long)]
    pub same_mass: bool,
    /// Folder for pictures of the damage of each part
    #[arg(long, value_name = "DIR")]
    pub preview: Option<PathBuf>,
    #[command(flatten)]
    pub common: Common,
}

/// `grainpath orient`
#[derive(Debug, clap::Args)]
pub(crate) struct Orient {
    /// Job file with fixtures and loads
    pub job: PathBuf,
    /// Write the rotation of the best pose into the job as shape.rotate_deg
    #[arg(long)]
    pub write: bool,
    /// Write a picture of the poses here: the part with its supports, and a ring where it first fails
    #[arg(long, value_name = "FILE.png")]
    pub image: Option<PathBuf>,
    #[command(flatten)]
    pub common: Common,
}

/// `grainpath render`
#[derive(Debug, clap::Args)]
pub(crate) struct Render {
    /// G-code of any slicer
    pub gcode: PathBuf,
    /// Number of the layer to draw, from 1 [default: the middle layer]
    #[arg(long, value_name = "N")]
    pub layer: Option<usize>,
    /// Picture to write, .png or .svg [default: the G-code's name with .png]
    #[arg(short, long, value_name = "FILE.png")]
    pub output: Option<PathBuf>,
    /// Quantity that the colour shows; `direction` is the angle between a bead and the direction its job asks for
    #[arg(long, default_value = "role", value_parser = ["role", "width", "speed", "direction"])]
    pub color: String,
    /// Job file whose guide gives the directions to compare the beads with
    #[arg(long, value_name = "JOB.toml", required_if_eq("color", "direction"))]
    pub job: Option<PathBuf>,
    /// Draw the whole part, shaded, instead of a layer
    #[arg(long)]
    pub part: bool,
    /// Longest side in pixels
    #[arg(long, default_value_t = 1600, value_parser = clap::value_parser!(u32).range(16..=20000))]
    pub size: u32,
    /// Draw no travels
    #[arg(long)]
    pub no_travels: bool,
}

/// `grainpath markers`
#[derive(Debug, clap::Args)]
pub(crate) struct Markers {
    /// Width of the rectangle between the markers, mm
    pub width_mm: f64,
    /// Height of the rectangle between the markers, mm
    pub height_mm: f64,
    /// Sheet to write, .svg or .pdf
    #[arg(short, long, value_name = "FILE.svg", default_value = "markers.svg")]
    pub output: PathBuf,
}

/// `grainpath schema`
#[derive(Debug, clap::Args)]
pub(crate) struct Schema {
    /// Print the reference page docs/settings.md instead of the schema
    #[arg(long)]
    pub markdown: bool,
}

/// `grainpath profiles`
#[derive(Debug, clap::Args)]
pub(crate) struct Profiles {
    /// Profile to print; without a name, all profiles are listed
    pub name: Option<String>,
    /// Print the list or the profile as one JSON object
    #[arg(long)]
    pub json: bool,
}

/// `grainpath doctor`
#[derive(Debug, clap::Args)]
pub(crate) struct Doctor {
    /// Print the answer as one JSON object
    #[arg(long)]
    pub json: bool,
}

/// `grainpath licences`
#[derive(Debug, clap::Args)]
pub(crate) struct Licences {}

/// `grainpath completions`
#[derive(Debug, clap::Args)]
pub(crate) struct Completions {
    /// The shell
    pub shell: clap_complete::Shell,
}

/// `grainpath man`
#[derive(Debug, clap::Args)]
pub(crate) struct Man {
    /// Folder to write `grainpath.1` and a page for each command to
    pub dir: PathBuf,
    /// Overwrite existing files
    #[arg(long)]
    pub force: bool,
}

/// `grainpath studio`
#[cfg(feature = "studio")]
#[derive(Debug, clap::Args)]
pub(crate) struct Studio {
    /// Job file, mesh, outline or G-code of any slicer to open first
    pub file: Option<PathBuf>,
    /// Print the address without opening a browser
    #[arg(long)]
    pub no_open: bool,
    /// Path put before every address, for a proxy that serves the studio below that path
    #[arg(long, value_name = "PATH", default_value = "")]
    pub base: String,
    /// Further folder whose files may be read; the current folder and the folder of FILE always may
    #[arg(long = "root", value_name = "DIR")]
    pub roots: Vec<PathBuf>,
    /// Further host name under which the studio answers, besides 127.0.0.1, localhost and `[::1]`
    #[arg(long = "allow-host", value_name = "NAME")]
    pub hosts: Vec<String>,
    /// Largest file that may be dropped on the page, bytes
    #[arg(long, value_name = "BYTES", default_value_t = 1_000_000_000)]
    pub max_upload: u64,
}
