//! The room of `tests/references` against the picture of another renderer, with ever more samples.

use super::{Outcome, Place, run};
use std::fs;
use std::path::Path;
use std::process::Command;

/// Samples a pixel of each render. They are averaged as they come, so the rows of the table have 16, 64, 256, 512,
/// 768, 1024 and 1280 samples.
const RENDERS: [u32; 7] = [16, 48, 192, 256, 256, 256, 256];

/// Pixels along the side of the blocks that are compared. A multiple of it is the picture's width and height.
const BLOCK: usize = 8;

/// By how much the means of the channels may differ at the end.
const MEANS: f64 = 3e-3;
/// The relative squared error of the blocks at the end.
const ERROR: f64 = 1e-4;
/// The error times the number of samples is the same in every row, but for this factor to the last one: the few
/// bright samples of the caustic rule the error, and make it waver. The reference's own noise is a tenth of what is
/// left at the end.
const WAVERING: f64 = 1.6;

/// Renders, compares, prints the table, and judges it.
pub fn agreement(place: &Place) -> Outcome {
    let folder = place.root.join("tests/references");
    let reference = Floats::read(&folder.join("room.pfm"))?;
    let mut sum = vec![0.0; reference.values.len()];
    let mut total = 0;
    let mut rows = vec![];
    println!("samples      red    green     blue   relMSE of blocks   median");
    for (seed, samples) in (1..).zip(RENDERS) {
        let picture = place.desk.join(format!("{seed}.pfm"));
        let mut command = Command::new(&place.rtc);
        command.arg("build").arg(folder.join("room.rt")).arg("--quiet");
        command.args(["--samples", &samples.to_string(), "--seed", &seed.to_string(), "-o"]).arg(&picture);
        run(&mut command)?;
        let values = Floats::read(&picture)?.values;
        if values.len() != sum.len() {
            return Err(format!("{} has another size than the reference", picture.display()));
        }
        sum.iter_mut().zip(values).for_each(|(sum, value)| *sum += f64::from(samples) * value);
        total += samples;
        let mean = sum.iter().map(|sum| sum / f64::from(total)).collect();
        let row = Row::new(total, &Floats { values: mean, width: reference.width }, &reference);
        let [r, g, b] = row.ratios;
        println!("{total:7} {r:8.5} {g:8.5} {b:8.5}   {:16.3e} {:8.2e}", row.error, row.median);
        rows.push(row);
    }
    judge(&rows)
}

fn judge(rows: &[Row]) -> Outcome {
    let Some(last) = rows.last() else { return Err("nothing was rendered".into()) };
    if let Some(ratio) = last.ratios.iter().find(|ratio| (*ratio - 1.0).abs() > MEANS) {
        return Err(format!("the mean of a channel is {ratio} of the reference's"));
    }
    if last.error > ERROR {
        return Err(format!("the blocks' relMSE is {:.3e}, above {ERROR:.0e}", last.error));
    }
    let constant = |row: &Row| f64::from(row.samples) * row.error;
    for row in rows {
        let factor = constant(row) / constant(last);
        if !(1.0 / WAVERING..=WAVERING).contains(&factor) {
            let Row { samples, error, .. } = row;
            return Err(format!(
                "the error does not fall as one over the samples: {error:.3e} at {samples} is off by {factor:.2}"
            ));
        }
    }
    Ok(())
}

/// How near a picture comes to the reference.
struct Row {
    samples: u32,
    /// Of the channels' means.
    ratios: [f64; 3],
    /// The mean over blocks and channels of (a − b)² / (b² + 0.01).
    error: f64,
    /// The median over the blocks, for the reader: the caustic leaves it alone.
    median: f64,
}

impl Row {
    fn new(samples: u32, ours: &Floats, theirs: &Floats) -> Row {
        let mut errors: Vec<f64> = ours
            .blocks()
            .into_iter()
            .zip(theirs.blocks())
            .map(|(a, b)| {
                (0..3).map(|c| (a[c] - b[c]) * (a[c] - b[c]) / (b[c] * b[c] + 0.01)).sum::<f64>() / 3.0
            })
            .collect();
        errors.sort_unstable_by(f64::total_cmp);
        let [a, b] = [ours, theirs].map(Floats::means);
        Row {
            samples,
            ratios: [0, 1, 2].map(|c| a[c] / b[c]),
            error: errors.iter().sum::<f64>() / errors.len() as f64,
            median: errors[errors.len() / 2],
        }
    }
}

/// A portable float map: red, green and blue of each pixel, rows from the bottom.
struct Floats {
    values: Vec<f64>,
    width: usize,
}

impl Floats {
    fn read(path: &Path) -> Result<Floats, String> {
        let bytes = fs::read(path).map_err(|error| format!("{}: {error}", path.display()))?;
        Floats::parse(&bytes).ok_or_else(|| format!("{} is no float map of whole blocks", path.display()))
    }

    /// Only what is written here and by the reference: three channels, little endian.
    fn parse(bytes: &[u8]) -> Option<Floats> {
        let mut lines = bytes.splitn(4, |byte| *byte == b'\n');
        let mut line = || std::str::from_utf8(lines.next()?).ok();
        let (magic, size, scale) = (line()?, line()?, line()?);
        let (width, height) = size.split_once(' ')?;
        let (width, height): (usize, usize) = (width.parse().ok()?, height.parse().ok()?);
        let data = lines.next()?;
        let whole = width % BLOCK == 0 && height % BLOCK == 0 && data.len() == 12 * width * height;
        if magic != "PF" || !scale.starts_with('-') || !whole {
            return None;
        }
        let value = |bytes: &[u8]| Some(f64::from(f32::from_le_bytes(bytes.try_into().ok()?)));
        Some(Floats { values: data.chunks_exact(4).map(value).collect::<Option<_>>()?, width })
    }

    /// Means over the whole.
    fn means(&self) -> [f64; 3] {
        let pixels = (self.values.len() / 3) as f64;
        [0, 1, 2].map(|c| self.values.iter().skip(c).step_by(3).sum::<f64>() / pixels)
    }

    /// Means over blocks.
    fn blocks(&self) -> Vec<[f64; 3]> {
        let across = self.width / BLOCK;
        let mut blocks = vec![[0.0; 3]; self.values.len() / (3 * BLOCK * BLOCK)];
        for (i, pixel) in self.values.chunks_exact(3).enumerate() {
            let block = &mut blocks[i / self.width / BLOCK * across + i % self.width / BLOCK];
            (0..3).for_each(|c| block[c] += pixel[c] / (BLOCK * BLOCK) as f64);
        }
        blocks
    }
}

#[cfg(test)]
mod tests {
    use super::{Floats, Row};

    fn map(values: &[f32]) -> Vec<u8> {
        let mut file = b"PF\n8 16\n-1.0\n".to_vec();
        file.extend(values.iter().flat_map(|v| v.to_le_bytes()));
        file
    }

    #[test]
    fn blocks_and_means_are_those_of_the_picture() {
        let values: Vec<f32> = (0..8 * 16 * 3).map(|i| if i < 192 { 1.0 } else { 3.0 }).collect();
        let picture = Floats::parse(&map(&values)).unwrap();
        assert_eq!(picture.blocks(), [[1.0; 3], [3.0; 3]]);
        assert_eq!(picture.means(), [2.0; 3]);
        let double = Floats { values: picture.values.iter().map(|v| 2.0 * v).collect(), width: 8 };
        let row = Row::new(1, &double, &picture);
        assert_eq!(row.ratios, [2.0; 3]);
        assert!((row.error - 0.5 * (1.0 / 1.01 + 9.0 / 9.01)).abs() < 1e-12);
        assert!(Floats::parse(&map(&values[1..])).is_none() && Floats::parse(b"P6\n").is_none());
    }
}
