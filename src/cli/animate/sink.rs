//! A film in one file: it is there when all of it is written, or not at all.

use super::super::input::is_standard;
use super::super::interrupt::Interrupt;
use super::super::target::{Aside, Target, print};
use super::super::{Problem, plain};
use super::names::{Form, place};
use super::video::{self, Video};
use rt_lang::output::animation::{Animation, CannotFilm, Reel};
use rt_lang::output::{Depth, Facts, Format, Picture};
use std::fs::File;
use std::io::{BufWriter, Seek};
use std::path::Path;

/// A film that is being made.
pub struct Sink {
    /// As one calls it.
    name: String,
    form: Form,
    reel: Reel,
    depth: Depth,
    place: Place,
    /// Keeps others from a place that is kept, where what lies beside it does not.
    _held: Option<Aside>,
    interrupt: Interrupt,
    /// None before the first frame.
    work: Option<Work>,
    /// Whether it was said that it will be too large.
    warned: bool,
}

enum Place {
    /// Beside where it will be.
    Aside(Aside),
    /// To be sent to standard output, from a file without a name.
    Standard(File),
}

enum Work {
    Own(Animation<BufWriter<File>>),
    Video(Video),
}

impl Sink {
    /// Makes sure that a film can be made and written there. Where it is kept what was made, there is a place that is always the
    /// same: see [`Aside::always_beside`].
    pub fn open(
        path: &Path,
        form: Form,
        (reel, depth): (Reel, Depth),
        keeps: bool,
        interrupt: &Interrupt,
    ) -> Result<Sink, Problem> {
        let to = place(path);
        let name = if is_standard(&to) { "standard output".into() } else { path.display().to_string() };
        if let Form::Video(_) = form {
            video::refuse_odd(reel.size)?;
            if reel.transparent {
                let problem = Problem::new(format!("`{name}` cannot be transparent; APNG and WebP can"));
                return Err(problem.help("write another format, or leave `background: transparent` out"));
            }
            video::find(&name)?;
        }
        let is_lent = matches!(form, Form::Video(_));
        let held = (keeps && is_lent).then(|| Aside::hold(&to, interrupt)).transpose()?;
        let place = if is_standard(&to) {
            // Refused where it is a terminal.
            Target { path: to, format: Format::Png }.stage(interrupt)?;
            let file = tempfile::tempfile().map_err(|error| cannot(&name, &plain(&error)))?;
            Place::Standard(file)
        } else if is_lent {
            Place::Aside(Aside::to_lend(&to, interrupt)?)
        } else if keeps {
            Place::Aside(Aside::always_beside(&to, interrupt)?)
        } else {
            Place::Aside(Aside::beside(&to, interrupt)?)
        };
        let interrupt = interrupt.clone();
        Ok(Sink { name, form, reel, depth, place, _held: held, interrupt, work: None, warned: false })
    }

    /// Adds a frame. Gives what is to be feared of those to come, once.
    pub fn add(&mut self, picture: &Picture, facts: &Facts) -> Result<Option<String>, Problem> {
        let work = match self.work.take() {
            Some(work) => work,
            None => self.begin()?,
        };
        let name = &self.name;
        match self.work.insert(work) {
            Work::Own(animation) => {
                animation.add(picture, facts).map_err(|error| cannot(name, &reason(error)))?;
                let fitting = animation.fitting().filter(|_| !self.warned);
                self.warned |= fitting.is_some();
                Ok(fitting.map(|fitting| {
                    let of = self.reel.frames;
                    format!(
                        "`{name}` can be 4 GiB large at most, and that is about {fitting} frames like those so far, not {of}; \
                         `-o film.apng` and videos have no such end, and `--resume` keeps the frames"
                    )
                }))
            }
            Work::Video(video) => {
                let frame = self.reel.raw(picture, facts);
                video.add(&frame.map_err(|reason| cannot(name, &reason.to_string()))?).map(|()| None)
            }
        }
    }

    fn begin(&self) -> Result<Work, Problem> {
        match (self.form, &self.place) {
            (Form::Own(motion), place) => {
                let file = match place {
                    Place::Aside(aside) => aside.file(),
                    Place::Standard(file) => file.try_clone(),
                };
                let to = BufWriter::new(file.map_err(|error| cannot(&self.name, &plain(&error)))?);
                let animation = Animation::begin(motion, self.reel, self.depth, to);
                animation.map(Work::Own).map_err(|error| cannot(&self.name, &reason(error)))
            }
            (Form::Video(container), Place::Aside(aside)) => {
                Video::begin(&self.reel, container, &aside.lend(), &self.interrupt).map(Work::Video)
            }
            // Names tell them apart before.
            (Form::Video(_), Place::Standard(..)) => Err(cannot(&self.name, "a video needs a file")),
        }
    }

    /// Ends the film, moves it to its place, and says in a line what it is.
    pub fn finish(self) -> Result<String, Problem> {
        let Sink { name, form, reel, place, work, .. } = self;
        match work {
            Some(Work::Own(animation)) => {
                animation.finish().map_err(|error| cannot(&name, &reason(error)))?
            }
            Some(Work::Video(video)) => video.finish()?,
            None => {}
        }
        match place {
            Place::Aside(mut aside) => {
                aside.sync()?;
                aside.finish()?;
            }
            Place::Standard(mut file) => {
                file.rewind().map_err(|error| cannot(&name, &plain(&error)))?;
                print(file)?;
            }
        }
        let ([width, height], frames) = (reel.size, reel.frames);
        let seconds = reel.rate.seconds(frames);
        let unit = if frames == 1 { "frame" } else { "frames" };
        Ok(format!("{name}: {} of {frames} {unit}, {width}×{height}, {seconds:.2} s", form.name()))
    }
}

fn cannot(name: &str, reason: &str) -> Problem {
    Problem::new(format!("cannot write `{name}`: {reason}"))
}

fn reason(error: CannotFilm) -> String {
    match error {
        CannotFilm::Write(error) => plain(&error),
        CannotFilm::Encode(error) => error.to_string(),
    }
}
