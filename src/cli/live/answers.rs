//! Answers about the picture that is being traced, beside the tracing.

use super::desk::{Desk, Job, Question};
use super::hub::{Hub, Mask};
use crate::cli::files::same_name;
use rt_lang::render::apart::Apart;
use rt_lang::render::first::FirstHits;
use rt_lang::render::{Control, Prepass, Tracer, Window};
use rt_lang::scene::{Primitive, PrimitiveId};
use rt_lang::span::Span;
use rt_lang::why::Why;
use std::time::{Duration, Instant};

/// Samples of a pixel that are watched together.
const TOGETHER: u32 = 64;
/// How long a pixel is taken apart, at least its first [`TOGETHER`] samples.
const PATIENCE: Duration = Duration::from_millis(200);

/// Answers questions about a job until there is a new one.
pub fn answer_all(desk: &Desk, hub: &Hub, tracer: &Tracer, prepass: &Prepass, job: &Job) {
    let mut first_hits = None;
    while let Some(question) = desk.question() {
        // Whoever asked may be gone.
        match question {
            Question::Why { pixel, reply } => drop(reply.send(why(hub, tracer, prepass, job, pixel))),
            Question::Light { file, place, reply } => {
                drop(reply.send(light(tracer, job, &mut first_hits, &file, place)));
            }
        }
    }
}

/// Takes a pixel apart, with the samples that the picture has of it, unless these are too many.
fn why(
    hub: &Hub,
    tracer: &Tracer,
    prepass: &Prepass,
    job: &Job,
    pixel: [u32; 2],
) -> Result<serde_json::Value, String> {
    let start = Instant::now();
    let [width, height] = job.scene().trace.size;
    if pixel[0] >= width || pixel[1] >= height {
        return Err(format!("the picture is {width}×{height}: it has no pixel {},{}", pixel[0], pixel[1]));
    }
    let most = hub.frame().filter(|frame| frame.step == 1).map_or(1, |frame| frame.samples[0].max(1));
    let mut apart = Apart::new(prepass.scale);
    while apart.samples() < most && (apart.samples() == 0 || start.elapsed() < PATIENCE) {
        let done = apart.samples();
        tracer.take_apart(pixel, done..most.min(done + TOGETHER), &mut apart);
    }
    let provenance = job.loaded.compiled.provenance(&job.loaded.sources).ok_or("the scene has errors")?;
    serde_json::to_value(Why::new(pixel, &apart, provenance)).map_err(|error| error.to_string())
}

/// Which pixels show what stands at a place of a file, or what is made of a material that does.
fn light(
    tracer: &Tracer,
    job: &Job,
    first_hits: &mut Option<FirstHits>,
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
    if first_hits.is_none() {
        *first_hits = tracer.first_hits(Window::whole(size), 1, &Control::new()).ok();
    }
    let hits = first_hits.as_ref()?;
    Some(Mask::of(size, |x, y| hits.pixel(x, y).shown().iter().any(|(id, _)| chosen[id.0 as usize])))
}
