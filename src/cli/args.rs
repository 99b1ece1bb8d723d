//! The flags and their help.

mod animating;
mod keeping;
mod merge;
mod tools;
mod values;
mod why;

pub use animating::{Animating, Only};
use clap::{Args, Parser, Subcommand};
pub use keeping::noise;
pub use keeping::{Every, Halting, Keeping, Resume, Shard};
pub use merge::Merge;
use rt_lang::aov::Aov;
use rt_lang::lower::Overrides;
use rt_lang::output::Depth;
use rt_lang::schema::Tonemap;
use std::net::SocketAddr;
use std::ops::RangeInclusive;
use std::path::PathBuf;
pub use tools::{
    Check, Completions, Expand, Explain, Export, Info, Init, Lsp, Man, Messages, Reading, Show, Viewpoint,
};
pub use values::Denied;
use values::{address, aov, crop, depths, exposure, lines, samples, seed, size, stops, threads, tonemaps};
pub use why::Why;

/// Renders .rt scenes: a small text that describes a picture becomes the picture.
///
/// A .rt file lists what is in the picture, each with its fields and units: `sphere { radius: 50cm }` alone
/// is a scene. A camera, a light and materials are chosen where none are given, and the report says which.
/// Mistakes are pointed at in the text, with their fix.
#[derive(Parser)]
#[command(name = "rtc", version, propagate_version = true, arg_required_else_help = true)]
#[command(after_help = EXAMPLES, after_long_help = LONG)]
pub struct Arguments {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

const EXAMPLES: &str = "\
Examples:
  rtc init balls                         a folder with a first scene
  rtc build balls.rt                     make balls.png
  rtc build balls.rt -o balls.exr        keep the radiance, to develop it later
  rtc check balls.rt                     only look for mistakes
  rtc explain E0203                      what a message means, with an example
  rtc develop balls.exr -o balls.png     develop it, at another exposure if you like

`rtc build --help` tells about every flag.";

const LONG: &str = "\
A first scene, balls.rt:

  camera { from: (0, 1, 4)m, look: (0, 0.5, 0)m }
  light { at: (2, 3, 2)m, power: 60W }
  plane { material: diffuse { color: #8a8f98 } }
  sphere { at: (0, 0.5, 0)m, radius: 50cm, material: diffuse { color: #d94f30 } }

Examples:
  rtc init balls                         a folder with a first scene
  rtc build balls.rt                     make balls.png
  rtc build balls.rt -o balls.exr        keep the radiance, to develop it later
  rtc check balls.rt                     only look for mistakes
  rtc explain E0203                      what a message means, with an example
  rtc develop balls.exr -o balls.png     develop it, at another exposure if you like

Exit codes:
  0    done (there may be warnings)
  1    a scene has errors, or warnings that are denied
  2    the command line is wrong, or a file cannot be read or written
  101  a bug in rtc
  130  interrupted

Colours are used on a terminal unless NO_COLOR is set.";

/// What to do.
#[derive(Subcommand)]
pub enum Command {
    /// Makes pictures from scenes.
    #[command(after_help = BUILD_EXAMPLES)]
    Build(Build),
    /// Makes the picture again whenever the scene is saved, and shows it in a browser if you like.
    #[command(after_help = WATCH_EXAMPLES)]
    Watch(Watch),
    /// Looks for mistakes in scenes, and makes no picture.
    #[command(after_help = tools::CHECK_EXAMPLES)]
    Check(Check),
    /// Puts the shares of a picture together that `rtc build --shard` made, to the bits that one machine would have made.
    #[command(after_help = merge::EXAMPLES)]
    Merge(Merge),
    /// Develops an EXR that `rtc build` made: exposure, tone mapping and format, without tracing again.
    #[command(after_help = DEVELOP_EXAMPLES)]
    Develop(Develop),
    /// Tells what a message means, with an example and its mend.
    #[command(after_help = tools::EXPLAIN_EXAMPLES)]
    Explain(Explain),
    /// Tells what is in a scene: parameters, cameras, counts, bounds, files, and what it takes to draw it.
    Info(Info),
    /// Tells why a pixel looks as it does: what it shows, and which lights give it its colour, by which paths.
    #[command(after_help = why::EXAMPLES)]
    Why(Why),
    /// Writes a scene as a flat one, without loops, parts and names, that gives the same picture to the bit.
    Expand(Expand),
    /// Writes a scene for another renderer: Mitsuba 3, pbrt-v4 or POV-Ray.
    Export(Export),
    /// Makes a folder with a first scene to play with.
    Init(Init),
    /// Prints a completion script for a shell.
    #[command(after_help = tools::COMPLETIONS_EXAMPLES)]
    Completions(Completions),
    /// Prints the manual page.
    #[command(after_help = tools::MAN_EXAMPLES)]
    Man(Man),
    /// Lays scenes out in the one way they are written: what they mean, their comments and their groups of lines
    /// stay as they are.
    #[command(after_help = FMT_EXAMPLES)]
    Fmt(Fmt),
    /// Serves an editor: diagnostics while you type, hovers, completion, renaming and more, over the Language Server
    /// Protocol on standard input and output.
    #[command(after_help = tools::LSP_EXAMPLES)]
    Lsp(Lsp),
}

const BUILD_EXAMPLES: &str = "\
Examples:
  rtc build balls.rt --size 160x120 --samples 8      a quick look
  rtc build balls.rt -o balls.png -o balls.exr       one picture in two forms
  rtc build balls.rt -o balls.exr --aov depth,object what else a picture shows
  rtc build balls.rt --crop 0,0,320,240 -o part.exr  only the top left quarter
  rtc build balls.rt --noise 1% --time 10min         until it is clean, but no longer
  rtc build balls.rt --samples 32 --denoise          a clean picture of few samples
  rtc build balls.rt --samples 4096 --checkpoint     if it is ended, the same again goes on
  rtc build balls.rt --sweep \"t = 0 to 1\" --frames 48 -o balls.webp    a film
  rtc build *.rt                                     each picture beside its scene
  cat balls.rt | rtc build - -o - > balls.png        standard input and output";

const WATCH_EXAMPLES: &str = "\
Examples:
  rtc watch balls.rt                       balls.png follows the text
  rtc watch balls.rt --serve --open        a page that shows it, with a slider for every param
  rtc watch balls.rt -o look.exr --samples 1024

It ends with Ctrl-C.";

const DEVELOP_EXAMPLES: &str = "\
Examples:
  rtc develop balls.exr -o bright.png --exposure 1.5
  rtc develop balls.exr -o film.png --tonemap agx --bits 16";

const FMT_EXAMPLES: &str = "\
Examples:
  rtc fmt *.rt                 lay out every scene of this folder
  rtc fmt --check *.rt         name those that are not laid out so
  cat balls.rt | rtc fmt -     standard input and output
  rtc fmt --lines 3:7 ball.rt  lay out what stands in lines 3 to 7

Exit codes:
  0    done
  1    a scene has errors: what they are in stays as it is; or, with --check, a scene would change
  2    a file cannot be read or written";

/// Flags of `rtc fmt`.
#[derive(Args)]
pub struct Fmt {
    /// Scenes to lay out; `-` is standard input, which goes to standard output.
    #[arg(value_name = "FILE", required = true)]
    pub files: Vec<PathBuf>,

    /// Lays out what stands in these lines alone, counted from 1.
    #[arg(long, value_name = "FIRST:LAST", value_parser = lines)]
    pub lines: Option<RangeInclusive<usize>>,

    /// Writes nothing, names the scenes that would change, and fails if there is one.
    #[arg(long)]
    pub check: bool,

    /// Writes nothing, and shows what would change as a unified diff.
    #[arg(long)]
    pub diff: bool,
}

/// Flags of `rtc build`.
#[derive(Args)]
pub struct Build {
    /// Scenes to make pictures of, one after the other; `-` is standard input.
    #[arg(value_name = "SCENE", required = true)]
    pub scenes: Vec<PathBuf>,

    /// Writes the picture here, in the format of the extension: png, exr, jpg, webp, hdr or pfm. May be given
    /// several times. `-` is standard output as PNG, `exr:-` as EXR and so on. Without it, the picture goes
    /// beside its scene as PNG.
    #[arg(short, long = "output", value_name = "OUT")]
    pub outputs: Vec<PathBuf>,

    /// Traces only a window: X and Y of its top left pixel, counted from 0 at the top left of the picture, then
    /// its width and height. Its pixels are those of the whole picture.
    #[arg(long, value_name = "X,Y,W,H", value_parser = crop)]
    pub crop: Option<[u32; 4]>,

    /// Adds channels of what the picture shows besides its light to its EXR: depth, normal, albedo, samples, error, and
    /// object and material as Cryptomatte; several with commas between.
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = aov())]
    pub aov: Vec<Aov>,

    /// Takes the noise out of the picture once it is traced, guided by the normals, colours and distances of what it shows. An
    /// EXR holds the picture as traced, and the one without noise as the layer `denoised`.
    #[arg(long)]
    pub denoise: bool,

    /// Watches some paths once the picture is made, and tells what makes its noise, which lights give nothing, what no
    /// path meets, and what the limit of bounces costs.
    #[arg(long)]
    pub feedback: bool,

    #[command(flatten)]
    #[allow(missing_docs)]
    pub taking: Taking,

    #[command(flatten)]
    #[allow(missing_docs)]
    pub halting: Halting,

    #[command(flatten)]
    #[allow(missing_docs)]
    pub keeping: Keeping,

    #[command(flatten)]
    #[allow(missing_docs)]
    pub animating: Animating,

    #[command(flatten)]
    #[allow(missing_docs)]
    pub reading: Reading,

    #[command(flatten)]
    #[allow(missing_docs)]
    pub messages: Messages,

    /// Says nothing but errors, and that work cannot be kept.
    #[arg(short, long)]
    pub quiet: bool,
}

/// How a picture is taken, in place of what the scene says.
#[derive(Args)]
pub struct Taking {
    /// Makes the picture this many pixels wide and high, in place of the scene's `size`.
    #[arg(long, value_name = "WxH", value_parser = size)]
    pub size: Option<[u32; 2]>,

    /// Traces this many paths a pixel, in place of the scene's `samples` or `noise`. Twice as many take twice
    /// as long and leave 0.7 of the noise.
    #[arg(long, value_name = "N", value_parser = samples, allow_negative_numbers = true)]
    pub samples: Option<u32>,

    /// Traces until the noise is so low, such as `1%` of white, in place of the scene's `samples` or `noise`: more samples
    /// go where there is more of it. With `--samples`, at most that many.
    #[arg(long, value_name = "SHARE", value_parser = noise, allow_negative_numbers = true)]
    pub noise: Option<f64>,

    /// Chooses the random numbers, in place of the scene's `seed`. The same seed gives the same picture.
    #[arg(long, value_name = "N", value_parser = seed, allow_negative_numbers = true)]
    pub seed: Option<u64>,

    /// Traces on this many threads. By default on all cores. The picture is the same for any number.
    #[arg(short = 'j', long = "threads", value_name = "N", value_parser = threads, allow_negative_numbers = true)]
    pub threads: Option<usize>,

    /// Takes the picture with the camera of this name, in place of the one that `render` names.
    #[arg(long, value_name = "NAME")]
    pub camera: Option<String>,

    /// Brightens by this many stops, in place of the camera's `exposure`: 1 is twice as bright, -1 half. `auto`
    /// chooses by the scene and prints the number.
    #[arg(long, value_name = "STOPS|auto", value_parser = exposure, allow_negative_numbers = true)]
    pub exposure: Option<Exposure>,

    #[command(flatten)]
    #[allow(missing_docs)]
    pub look: Look,
}

impl Taking {
    /// What the compiler is told of it.
    pub fn overrides(&self) -> Overrides {
        Overrides {
            camera: self.camera.clone(),
            size: self.size,
            samples: self.samples,
            noise: self.noise,
            seed: self.seed,
            exposure: self.exposure.map(|exposure| match exposure {
                Exposure::Auto => None,
                Exposure::Stops(stops) => Some(stops),
            }),
            tonemap: self.look.tonemap,
            ..Overrides::default()
        }
    }
}

/// Flags of `rtc watch`.
#[derive(Args)]
pub struct Watch {
    /// The scene to follow.
    #[arg(value_name = "SCENE")]
    pub scene: PathBuf,

    /// Writes the picture here whenever its samples have doubled, in the format of the extension. May be given several
    /// times. Without it the picture goes beside its scene as PNG, or with `--serve` nowhere.
    #[arg(short, long = "output", value_name = "OUT")]
    pub outputs: Vec<PathBuf>,

    /// Shows the picture on a page of this machine alone, and prints the page's address on standard output. Without a
    /// port on 4877, or on one that is free where that is taken.
    #[arg(long, value_name = "127.0.0.1:PORT", num_args = 0..=1, require_equals = true,
        default_missing_value = "127.0.0.1:0", value_parser = address)]
    pub serve: Option<SocketAddr>,

    /// Opens the page in the browser.
    #[arg(long, requires = "serve")]
    pub open: bool,

    /// Where places in the page lead: {file}, {line} and {column} are put in.
    #[arg(
        long,
        value_name = "TEMPLATE",
        requires = "serve",
        default_value = "vscode://file{file}:{line}:{column}"
    )]
    pub editor_url: String,

    /// Lets places in the page run the command that RTC_EDITOR names, with {file}, {line} and {column} put in.
    #[arg(long, requires = "serve")]
    pub open_with: bool,

    /// Looks for changes every so many milliseconds, where the system does not tell of them.
    #[arg(long, value_name = "MS", num_args = 0..=1, require_equals = true, default_missing_value = "500",
        value_parser = clap::value_parser!(u64).range(1..=3_600_000))]
    pub poll: Option<u64>,

    #[command(flatten)]
    #[allow(missing_docs)]
    pub taking: Taking,

    #[command(flatten)]
    #[allow(missing_docs)]
    pub reading: Reading,

    /// Says nothing but errors.
    #[arg(short, long)]
    pub quiet: bool,
}

/// How a picture is developed and stored.
#[derive(Args)]
pub struct Look {
    /// Goes from radiance to display by this curve, in place of the scene's `tonemap`.
    #[arg(long, value_name = "NAME", value_parser = tonemaps())]
    pub tonemap: Option<Tonemap>,

    /// Bits a channel of PNG files.
    #[arg(long, value_name = "8|16", default_value = "8", value_parser = depths())]
    pub bits: Depth,
}

/// Flags of `rtc develop`.
#[derive(Args)]
pub struct Develop {
    /// The EXR to develop; `-` is standard input.
    #[arg(value_name = "IN.exr")]
    pub input: PathBuf,

    /// Writes the picture here, in the format of the extension: png, exr, jpg, webp, hdr or pfm. May be given
    /// several times. `-` is standard output as PNG, `jpg:-` as JPEG and so on.
    #[arg(short, long = "output", value_name = "OUT", required = true)]
    pub outputs: Vec<PathBuf>,

    /// Brightens by this many stops: 1 is twice as bright, -1 half. By default by what the picture was built
    /// with, which the EXR holds; 0 for one from another program.
    #[arg(long, value_name = "STOPS", value_parser = stops, allow_negative_numbers = true)]
    pub exposure: Option<f64>,

    /// Develops the picture as it was traced, where the EXR holds it without noise too.
    #[arg(long)]
    pub noisy: bool,

    #[command(flatten)]
    #[allow(missing_docs)]
    pub look: Look,

    /// Says nothing but errors.
    #[arg(short, long)]
    pub quiet: bool,
}

/// Value of `--exposure`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Exposure {
    /// By the scene.
    Auto,
    /// So many stops.
    Stops(f64),
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_definitions_are_consistent() {
        use clap::CommandFactory;
        Arguments::command().debug_assert();
    }
}
