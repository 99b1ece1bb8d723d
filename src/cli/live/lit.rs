//! From a place of a text to the pixels that show what stands there.

use super::desk::{Desk, Job};
use super::hub::Mask;
use crate::cli::files::same_name;
use rt_lang::render::{Control, Tracer, Window};
use rt_lang::scene::{Background, Light, PrimitiveId};
use rt_lang::source::Source;
use rt_lang::span::{SourceId, Span};
use rt_lang::why::Provenance;

/// Rows that are looked at together.
const BAND: u32 = 64;

/// What the pixels of a picture show, row by row.
pub type Seen = Vec<Option<PrimitiveId>>;

/// What stands at a place, as far as pixels can show it.
enum Thing {
    /// Those primitives of the scene for which this is true.
    Primitives(Vec<bool>),
    /// What is seen where nothing stands.
    Sky,
}

impl Thing {
    fn is(&self, shown: Option<PrimitiveId>) -> bool {
        match (self, shown) {
            (Thing::Primitives(chosen), Some(id)) => chosen[id.0 as usize],
            (Thing::Sky, None) => true,
            _ => false,
        }
    }
}

/// Which pixels show what stands at a place of a file, or what is made of a material that does; or why none does. Line and
/// column count from 1; column 0 is where the line's first word begins. What the pixels show is kept in `seen`.
pub fn light(
    desk: &Desk,
    tracer: &Tracer,
    job: &Job,
    seen: &mut Option<Seen>,
    file: &str,
    [line, column]: [u32; 2],
) -> Result<Mask, String> {
    let sources = &job.loaded.sources;
    let (id, source) = sources
        .iter()
        .find(|(_, source)| same_name(&source.name, file))
        .ok_or_else(|| format!("the scene has no text `{file}`"))?;
    let byte = byte(source, line, column).ok_or_else(|| format!("`{file}` has no line {line}"))?;
    let provenance = job.loaded.compiled.provenance(sources).ok_or("the scene has errors")?;
    let thing = find(provenance, id, byte)?;
    let size = job.scene().trace.size;
    if seen.is_none() {
        *seen = look(tracer, size, &desk.begin_answer());
    }
    let seen = seen.as_ref().ok_or("there is a newer text")?;
    Ok(Mask::of(size, |x, y| thing.is(seen[y as usize * size[0] as usize + x as usize])))
}

/// The byte of a place.
fn byte(source: &Source, line: u32, column: u32) -> Option<u32> {
    let byte = source.byte(line as usize, column.max(1) as usize)?;
    let blanks = match column {
        0 => source.text[source.line_range(byte)].bytes().take_while(u8::is_ascii_whitespace).count(),
        _ => 0,
    };
    Some((byte + blanks) as u32)
}

/// The smallest thing around a place.
fn find(from: Provenance, source: SourceId, byte: u32) -> Result<Thing, String> {
    let around = |span: Span| {
        let is_around = span.source == source && span.start <= byte && byte <= span.end;
        is_around.then(|| span.end - span.start)
    };
    let nearest = |origin| from.origins.chain(origin).into_iter().filter_map(around).min();
    let primitives = (0..).map(PrimitiveId).zip(from.scene.primitives.iter());
    let sizes: Vec<Option<u32>> = primitives
        .map(|(id, primitive)| {
            let material = from.marks.materials.of(id).and_then(|(span, _)| around(span));
            nearest(primitive.origin).into_iter().chain(material).min()
        })
        .collect();
    let primitive = sizes.iter().flatten().min();
    let lights = from.scene.lights.iter().zip(&from.marks.lights);
    let light = lights.filter_map(|(light, origin)| Some((nearest((*origin)?)?, light)));
    match light.min_by_key(|(size, _)| *size) {
        Some((size, light)) if primitive.is_none_or(|primitive| size < *primitive) => match light {
            Light::Sky { .. } if from.scene.trace.background == Background::Sky => Ok(Thing::Sky),
            Light::Sky { .. } => Err("the background is transparent: no pixel shows the sky".into()),
            Light::Point { .. } | Light::Spot { .. } => {
                Err("the light that stands there is a point: no pixel shows it".into())
            }
            Light::Sun { .. } => Err("the sun is no surface: no pixel is of it alone".into()),
        },
        _ if primitive.is_some() => {
            Ok(Thing::Primitives(sizes.iter().map(|size| size.as_ref() == primitive).collect()))
        }
        _ => Err("nothing stands there that a pixel could show".into()),
    }
}

/// What the pixels of a picture show. None where it is cancelled.
fn look(tracer: &Tracer, size: [u32; 2], control: &Control) -> Option<Seen> {
    let [width, height] = size;
    let mut seen = Vec::with_capacity(width as usize * height as usize);
    // What is known of a pixel at first is much larger than what is kept.
    for y in (0..height).step_by(BAND as usize) {
        let band = Window { x: 0, y, width, height: BAND.min(height - y) };
        let hits = tracer.first_hits(band, 1, control).ok()?;
        let pixels = (y..y + band.height).flat_map(|y| (0..width).map(move |x| (x, y)));
        seen.extend(pixels.map(|(x, y)| hits.pixel(x, y).shown().first().map(|(id, _)| *id)));
    }
    Some(seen)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_alone_is_its_first_word() {
        let source = Source::new("s.rt", "a\n  béta\r\n\t\r\n");
        let at = |line, column| byte(&source, line, column);
        assert_eq!([at(1, 0), at(2, 0), at(2, 1), at(2, 5)], [Some(0), Some(4), Some(2), Some(7)]);
        assert_eq!([at(3, 0), at(2, 99), at(9, 0), at(0, 0)], [Some(12), Some(9), None, None]);
    }
}
