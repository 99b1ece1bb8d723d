//! Answers about the picture that is being traced, beside the tracing.

use super::desk::{Desk, Job, Question};
use super::hub::{Frame, Hub, Known};
use super::lit;
use rt_lang::render::apart::Apart;
use rt_lang::render::{Prepass, Tracer};
use rt_lang::why::{SamplesBy, Why};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Samples of a pixel that are watched together.
const TOGETHER: u32 = 16;
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
                drop(reply.send(lit::light(desk, tracer, job, &mut seen, &file, place)));
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
    let is_traced =
        |frame: &Arc<Frame>| frame.step == 1 && !frame.remixed && frame.generation == job.generation;
    let frame = hub.frame().filter(is_traced);
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
