//! Answers about the picture that is being traced, beside the tracing.

use super::desk::{Desk, Job, Question};
use super::hub::{Hub, Known, Mask};
use crate::cli::files::same_name;
use rt_lang::render::apart::Apart;
use rt_lang::render::{Control, Prepass, Tracer, Window};
use rt_lang::scene::{Primitive, PrimitiveId};
use rt_lang::span::Span;
use rt_lang::why::{SamplesBy, Why};
use std::time::{Duration, Instant};

/// Samples of a pixel that are watched together.
const TOGETHER: u32 = 16;
/// Rows that are looked at together.
const BAND: u32 = 64;
/// How long a pixel is taken apart for who wants to know at once, and for who is patient; at least its first
/// [`TOGETHER`] samples.
const AT_ONCE: Duration = Duration::from_millis(2);
const PATIENCE: Duration = Duration::from_millis(200);

/// Answers questions about a job until there is a new one.
pub fn answer_all(desk: &Desk, hub: &Hub, tracer: &Tracer, prepass: &Prepass, job: &Job) {
    let mut seen = None;
    while let Some(question) = desk.question() {
        // Whoever asked may be gone.
        match question {
            Question::Why { pixel, patient, reply } => {
                let patience = if patient { PATIENCE } else { AT_ONCE };
                drop(reply.send(why(desk, hub, (tracer, prepass), job, pixel, patience)));
            }
            Question::Light { file, place, reply } => {
                drop(reply.send(light(desk, tracer, job, &mut seen, &file, place)));
            }
        }
    }
}

/// Takes a pixel apart, with the samples that the picture has of it, unless these are too many.
fn why(
    desk: &Desk,
    hub: &Hub,
    (tracer, prepass): (&Tracer, &Prepass),
    job: &Job,
    pixel: [u32; 2],
    patience: Duration,
) -> Result<Known, String> {
    let start = Instant::now();
    let [width, height] = job.scene().trace.size;
    if pixel[0] >= width || pixel[1] >= height {
        return Err(format!("the picture is {width}×{height}: it has no pixel {},{}", pixel[0], pixel[1]));
    }
    let frame = hub.frame().filter(|frame| frame.step == 1 && frame.generation == job.generation);
    let most = frame.map_or(1, |frame| frame.samples[0].max(1));
    let mut apart = Apart::new(prepass.scale);
    while apart.samples() < most && (apart.samples() == 0 || start.elapsed() < patience && !desk.is_news()) {
        let done = apart.samples();
        tracer.take_apart(pixel, done..most.min(done + TOGETHER), &mut apart);
    }
    let provenance = job.loaded.compiled.provenance(&job.loaded.sources).ok_or("the scene has errors")?;
    let why = Why::new(pixel, &apart, SamplesBy::Picture, provenance);
    let why = serde_json::to_value(why).map_err(|error| error.to_string())?;
    Ok(Known { why, more: apart.samples() < most })
}

/// Which pixels show what stands at a place of a file, or what is made of a material that does.
fn light(
    desk: &Desk,
    tracer: &Tracer,
    job: &Job,
    seen: &mut Option<Vec<Option<PrimitiveId>>>,
    file: &str,
    [line, column]: [u32; 2],
) -> Option<Mask> {
    let sources = &job.loaded.sources;
    let (id, source) = sources.iter().find(|(_, source)| same_name(&source.name, file))?;
    let byte = source.byte(line as usize, column as usize)? as u32;
    let is_there = |span: Span| span.source == id && span.start <= byte && byte <= span.end;
    let compiled = &job.loaded.compiled;
    let marks = &compiled.provenance(sources)?.marks.materials;
    let chosen = |(id, primitive): (PrimitiveId, &Primitive)| {
        compiled.origins.chain(primitive.origin).into_iter().any(is_there)
            || marks.of(id).is_some_and(|(span, _)| is_there(span))
    };
    let primitives = job.scene().primitives.iter();
    let chosen: Vec<bool> = (0..).map(PrimitiveId).zip(primitives).map(chosen).collect();
    if !chosen.contains(&true) {
        return None;
    }
    let size = job.scene().trace.size;
    if seen.is_none() {
        *seen = Some(look(tracer, size, &desk.begin_answer())?);
    }
    let seen = seen.as_ref()?;
    let id = |x: u32, y: u32| seen[y as usize * size[0] as usize + x as usize];
    Some(Mask::of(size, |x, y| id(x, y).is_some_and(|id| chosen[id.0 as usize])))
}

/// What the pixels of a picture show, row by row. None where it is cancelled.
fn look(tracer: &Tracer, size: [u32; 2], control: &Control) -> Option<Vec<Option<PrimitiveId>>> {
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
