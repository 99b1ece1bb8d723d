//! The table of docs/denoising.md: how far pictures are from the truth with their noise and without.

use super::{Outcome, fresh, root, run};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// What is measured, below `examples`.
const SCENES: &[&str] = &[
    "report/figure-02-opaque",
    "report/figure-03-specular",
    "report/figure-04-transparent",
    "report/figure-05-indirect",
    "report/figure-06-antialiasing",
    "report/figure-07-focus",
    "report/figure-08-camera",
    "report/figure-09-hyperboloids",
    "report/figure-10-parallel",
    "garden/garden",
    "hyperboloid-tower",
    "marbles",
    "newton",
    "one-weekend",
    "sphereflake",
    "three-balls",
    "turntable",
];
/// The size of its picture.
const SIZE: &str = "160x120";
/// Samples a pixel.
const SAMPLES: [u32; 3] = [4, 16, 64];
/// Those of the truth, which has another seed.
const TRUTH: u32 = 1024;

/// Red, green and blue of each pixel.
type Pixels = Vec<[f32; 3]>;

/// Makes the pictures and prints the table; they are left in `target/denoise` to look at.
pub fn table() -> Outcome {
    let root = root()?;
    run(Command::new("cargo").args(["build", "--release", "--quiet", "--bin", "rtc"]).current_dir(&root))?;
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root.join("target"), PathBuf::from);
    let (rtc, desk) = (root.join(&target).join("release/rtc"), root.join(&target).join("denoise"));
    fresh(&desk)?;
    println!(
        "| scene | samples | traced, s | denoised, s | relMSE, noisy | denoised | | trimmed, noisy | denoised | |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|");
    for path in SCENES {
        let scene = format!("examples/{path}.rt");
        let name = path.rsplit('/').next().unwrap_or(path);
        let build = |rest: &str| -> Result<String, String> {
            let mut command = Command::new(&rtc);
            command.arg("build").arg(root.join(&scene)).args(["--size", SIZE]).args(rest.split(' '));
            told(command.current_dir(&desk))
        };
        let file = format!("{name}-truth");
        build(&format!("--samples {TRUTH} --seed 77 -o {file}.pfm -o {file}.png"))?;
        let truth = read_pfm(&desk.join(file + ".pfm"))?;
        for samples in SAMPLES {
            let file = format!("{name}-{samples}");
            let said =
                build(&format!("--samples {samples} --denoise -o {file}.exr -o {file}.pfm -o {file}.png"))?;
            let mut develop = Command::new(&rtc);
            develop.args(["develop", "--noisy"]).arg(format!("{file}.exr"));
            develop.arg("-o").arg(format!("{file}-noisy.pfm")).arg("-o").arg(format!("{file}-noisy.png"));
            told(develop.current_dir(&desk))?;
            let clean = errors(&read_pfm(&desk.join(format!("{file}.pfm")))?, &truth)?;
            let noisy = errors(&read_pfm(&desk.join(format!("{file}-noisy.pfm")))?, &truth)?;
            let [all, denoised] = [("samples", " in "), (", denoised in ", "")]
                .map(|(after, then)| seconds(&said, after, then));
            println!(
                "| `{scene}` | {samples} | {:.1} | {denoised:.1} | {:.4} | {:.4} | {:.1} × | {:.4} | {:.4} | {:.1} × |",
                all - denoised,
                noisy[0],
                clean[0],
                noisy[0] / clean[0],
                noisy[1],
                clean[1],
                noisy[1] / clean[1],
            );
        }
    }
    Ok(())
}

/// Runs a command to its end, and gives what it said.
fn told(command: &mut Command) -> Result<String, String> {
    let output = command.output().map_err(|error| format!("rtc does not start: {error}"))?;
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    if output.status.success() { Ok(said) } else { Err(said) }
}

/// The time that a report tells behind some words, in seconds.
fn seconds(said: &str, after: &str, then: &str) -> f64 {
    let behind = said.split_once(after).and_then(|(_, rest)| rest.split_once(then));
    let words: Vec<&str> = behind.map_or(vec![], |(_, time)| time.split([' ', ',']).take(4).collect());
    let number = |word: Option<&&str>| word.and_then(|word| word.parse::<f64>().ok()).unwrap_or(f64::NAN);
    match words.get(1) {
        Some(&"ms") => 1e-3 * number(words.first()),
        Some(&"min") => 60.0 * number(words.first()) + number(words.get(2)),
        _ => number(words.first()),
    }
}

/// The mean of (x − r)²/(r² + 0.01) over channels and pixels, and the same without the worst hundredth of the pixels.
fn errors(picture: &Pixels, truth: &Pixels) -> Result<[f64; 2], String> {
    if picture.len() != truth.len() || picture.is_empty() {
        return Err("pictures of different sizes".into());
    }
    let channel = |x: f32, r: f32| {
        let (x, r) = (f64::from(x), f64::from(r));
        (x - r) * (x - r) / (r * r + 0.01)
    };
    let pixel = |(x, r): (&[f32; 3], &[f32; 3])| (0..3).map(|c| channel(x[c], r[c])).sum::<f64>() / 3.0;
    let mut each: Vec<f64> = picture.iter().zip(truth).map(pixel).collect();
    each.sort_by(f64::total_cmp);
    let kept = each.len() - each.len() / 100;
    Ok([each.len(), kept].map(|count| each[..count].iter().sum::<f64>() / count as f64))
}

/// The floats of a PFM as this program writes them, in the order of the file.
fn read_pfm(path: &Path) -> Result<Pixels, String> {
    let bytes = fs::read(path).map_err(|error| format!("{}: {error}", path.display()))?;
    let header =
        bytes.iter().enumerate().filter(|(_, byte)| **byte == b'\n').nth(2).map_or(0, |(at, _)| at + 1);
    let floats: Vec<f32> = bytes[header..]
        .chunks_exact(4)
        .map(|word| f32::from_le_bytes([word[0], word[1], word[2], word[3]]))
        .collect();
    Ok(floats.chunks_exact(3).map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect())
}
