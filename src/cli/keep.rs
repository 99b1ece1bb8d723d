//! Keeps the samples of a picture in the making, and goes on from them.

mod account;

use super::args::{Build, Every, Keeping, Resume};
use super::build::Context;
use super::interrupt::Interrupt;
use super::target::{Aside, Target};
use super::{Problem, build, input, plain};
pub use account::Account;
use account::Amount;
use rt_lang::output::{Facts, is_exr};
use rt_lang::render::Shown;
use rt_lang::render::making::Making;
use rt_lang::saved::{self, Head, Refused, Saved, Share, Subject};
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// What the name of a checkpoint has behind that of its picture.
pub const SUFFIX: &str = ".checkpoint";

/// The bytes of a file that are looked at for what it is of: the head of one is far smaller.
pub const HEAD: u64 = 1 << 18;

/// What messages call the samples that are there, where they are of another picture.
pub const CALLED: &str = "kept";

/// How many times as long as keeping them took samples are traced before they are kept again, so that a large picture is not kept
/// for more of the time than it is made.
const COST: u32 = 20;

/// Where the samples of a picture are kept, and where they come from.
pub struct Places {
    /// Where they are kept.
    to: PathBuf,
    /// Whether a flag names that file.
    named: bool,
    /// Where they come from, and whether there must be some.
    from: Option<(PathBuf, bool)>,
    /// Whether samples of another picture are left aside, and not an error.
    yields: bool,
}

impl Places {
    /// The same for a frame of a film: where the scene has changed, it is made anew.
    pub fn yielding(self) -> Places {
        Places { yields: true, ..self }
    }

    /// Refuses to replace one of the files that the picture is made of.
    pub fn refuse_replacing(&self, inputs: &[PathBuf]) -> Result<(), Problem> {
        refuse_replacing(inputs, &self.to, self.named)
    }

    /// Refuses to replace what is no checkpoint, and not even a torn one, under a name that may be of anything.
    fn refuse_foreign(&self) -> Result<(), Problem> {
        if !self.named || !input::is_there(&self.to)? {
            return Ok(());
        }
        let problem = |why: String| {
            let to = self.to.display();
            Problem::new(format!("`{to}` would be replaced by the checkpoint, and {why}"))
                .help("remove it, or name another file: `--checkpoint=FILE`")
        };
        let start = start(&self.to).map_err(|error| problem(format!("cannot be read: {}", plain(&error))))?;
        Head::recognize(&start).map_err(|why| problem(why.to_string()))
    }
}

/// A checkpoint is of one scene, and is none itself.
pub fn refuse_checkpoints_of_others(arguments: &Build) -> Result<(), Problem> {
    let named = match &arguments.keeping {
        Keeping { checkpoint: Some(Some(file)), .. } | Keeping { resume: Some(Resume::From(file)), .. } => {
            file
        }
        _ => return Ok(()),
    };
    if arguments.scenes.len() > 1 {
        let problem = Problem::new("several scenes cannot be kept in one file");
        return Err(problem.help("without its name each checkpoint goes beside its picture"));
    }
    refuse_replacing(&arguments.scenes, named, true)
}

/// Refuses to keep samples in one of these files.
fn refuse_replacing(inputs: &[PathBuf], to: &PathBuf, named: bool) -> Result<(), Problem> {
    let Some(to) = build::first_replaced(inputs, std::slice::from_ref(to)) else { return Ok(()) };
    let problem = Problem::new(format!("`{}` would be replaced by the checkpoint", to.display()));
    Err(problem.help(if named {
        "name another file: `--checkpoint=FILE`"
    } else {
        "name another output with `-o`"
    }))
}

/// The file of `--checkpoint FILE`, with a space, is taken for a scene.
pub fn refuse_loose_files(arguments: &Build) -> Result<(), Problem> {
    let Build { scenes, outputs, animating, keeping, .. } = arguments;
    let flag = match keeping {
        Keeping { checkpoint: Some(None), .. } => "--checkpoint",
        Keeping { resume: Some(Resume::Auto), .. } => "--resume",
        _ => return Ok(()),
    };
    let of_one = !outputs.is_empty() || animating.frames.is_some();
    let is_loose = |scene: &&PathBuf| {
        !input::is_standard(scene)
            && scene.extension().is_none_or(|extension| extension != "rt")
            && (of_one || !scene.exists() || begins_as_exr(scene))
    };
    let Some(file) = scenes.iter().find(is_loose).filter(|_| scenes.len() > 1) else { return Ok(()) };
    let file = file.display();
    let problem =
        Problem::new(format!("`{file}` is taken for a scene, and is probably the file of `{flag}`"));
    Err(problem.help(format!("a file stands behind `=`, without a space: `{flag}={file}`")))
}

/// What is said of how to keep must find something that is kept.
pub fn refuse_idle(keeping: &Keeping) -> Result<(), Problem> {
    let Keeping { wait, checkpoint_every, .. } = keeping;
    let told = [
        (wait.is_some(), "`--wait` is for work that is kept: else nobody is in the way"),
        (checkpoint_every.is_some(), "`--checkpoint-every` is for work that is kept, and none is"),
    ];
    match told.into_iter().find(|(is_given, _)| *is_given) {
        Some((_, why)) if !keeping.keeps() => {
            let help = "keep it with `--checkpoint` or `--resume`, or leave the flag out";
            Err(Problem::new(why).help(help))
        }
        _ => Ok(()),
    }
}

/// The places that flags name, for a picture that goes to these targets; none where nothing is to be kept.
pub fn places(arguments: &Keeping, targets: &[Target]) -> Result<Option<Places>, Problem> {
    if !arguments.keeps() {
        return Ok(None);
    }
    let (to, named) = match (&arguments.checkpoint, &arguments.resume) {
        (Some(Some(file)), _) | (_, Some(Resume::From(file))) => (file.clone(), true),
        _ => (beside(targets)?, false),
    };
    if targets.iter().any(|target| build::same(&target.path) == build::same(&to)) {
        let problem =
            Problem::new(format!("`{}` would be both the picture and its checkpoint", to.display()));
        return Err(problem.help("name another file: `--checkpoint=FILE`"));
    }
    let from = match &arguments.resume {
        Some(Resume::Never) => None,
        Some(Resume::From(file)) => Some((file.clone(), true)),
        Some(Resume::Auto) | None => Some((to.clone(), false)),
    };
    Ok(Some(Places { to, named, from, yields: false }))
}

/// Where the samples of a picture are kept that goes to these targets, unless a flag says it.
pub fn beside(targets: &[Target]) -> Result<PathBuf, Problem> {
    let file = targets.iter().find(|target| !input::is_standard(&target.path));
    let Some(file) = file else {
        let problem = Problem::new("a picture on standard output has no name to put its checkpoint beside");
        return Err(problem.help("name a file: `--checkpoint=FILE`"));
    };
    let mut name = file.path.clone().into_os_string();
    name.push(SUFFIX);
    Ok(name.into())
}

/// Reads a file of samples, or says why it is none. No more of it is read than its head promises. Only one that is `plain` may
/// not be a pipe or standard input.
pub fn load(path: &Path, plain: bool) -> Result<Result<Saved, Refused>, Problem> {
    let bytes =
        input::read_judged(path, plain, HEAD, |start| Head::decode(start).map(|head| head.most_bytes()))?;
    Ok(bytes.and_then(|bytes| Saved::decode(&bytes)))
}

/// What a file of samples says that it is of; none where it is no such file.
pub fn head(path: &Path) -> Option<Head> {
    Head::decode(&start(path).ok()?).ok()
}

fn begins_as_exr(path: &Path) -> bool {
    start(path).is_ok_and(|bytes| is_exr(&bytes))
}

/// As much of a plain file as its head may have.
fn start(path: &Path) -> io::Result<Vec<u8>> {
    let mut start = vec![];
    input::open_plain(path)?.take(HEAD).read_to_end(&mut start)?;
    Ok(start)
}

/// Keeps samples every now and then.
pub struct Keeper<'a> {
    places: Places,
    every: Every,
    subject: &'a Subject,
    /// How the picture comes about, as far as that is known before.
    facts: &'a Facts,
    context: &'a Context<'a>,
    /// Keeps others from the file meanwhile, who would replace what is kept by less.
    held: Option<Aside>,
    /// When they were kept last, and how many samples a pixel those were.
    last: (Instant, f64),
    /// How long that took.
    cost: Duration,
    account: Account,
    /// Whether it was said that they cannot be kept.
    complained: bool,
    /// How the picture that is kept was when a noise target last decided where its samples go.
    judged: Option<Shown>,
}

impl<'a> Keeper<'a> {
    /// One that keeps what depends on this.
    pub fn new(
        places: Places,
        (subject, facts): (&'a Subject, &'a Facts),
        context: &'a Context<'a>,
    ) -> Keeper<'a> {
        let (every, last) = (context.arguments.keeping.every(), (Instant::now(), 0.0));
        let (held, cost, account, complained) = (None, Duration::ZERO, Account::default(), false);
        let judged = None;
        Keeper { places, every, subject, facts, context, held, last, cost, account, complained, judged }
    }

    /// Keeps others from where the samples are kept, which must be a place where they can be.
    pub fn hold(&mut self) -> Result<(), Problem> {
        if let Some((path, true)) = &self.places.from {
            input::open_plain(path).map_err(|error| input::cannot_read(path, &error))?;
        }
        self.held = Some(Aside::hold(&self.places.to, self.context.interrupt)?);
        drop(Aside::always_beside(&self.places.to, self.context.interrupt)?);
        Ok(())
    }

    /// The picture to go on with; none where there is nothing to go on from. What differs is an error, in what `refuses` says
    /// too; and so is a file that is damaged, for nobody should lose work by going on without it, though a frame of a film is begun
    /// anew. To be called where [`Keeper::hold`] was.
    pub fn resume(
        &mut self,
        refuses: impl FnOnce(&Making) -> Option<String>,
    ) -> Result<Option<Making>, Problem> {
        if !matches!(&self.places.from, Some((path, true)) if *path == self.places.to) {
            self.places.refuse_foreign()?;
            self.refuse_share()?;
        }
        let Some((path, must_be)) = &self.places.from else { return Ok(None) };
        if !must_be && !input::is_there(path)? {
            return Ok(None);
        }
        let saved = load(path, true)?;
        let cannot = |why: String, help: &str| {
            Problem::new(format!("cannot go on from `{}`: {why}", path.display())).help(help)
        };
        if let (Err(why), true) = (&saved, self.places.yields) {
            self.say_begun_anew(path, &format!("it {why}"));
            return Ok(None);
        }
        let saved = saved.map_err(|why| {
            let help = match must_be {
                true => "name a file that `--checkpoint` wrote, or begin afresh with `--resume=never`",
                false => {
                    "`--checkpoint=FILE` keeps the samples elsewhere, and `--resume=never` begins afresh and replaces it"
                }
            };
            cannot(format!("it {why}"), help)
        })?;
        const REPLACES: &str = "`rtc develop` makes a picture of those that are there, and `--resume=never` begins afresh and replaces them";
        let otherwise = match self.places.yields {
            // The frames of a film are kept beside them.
            true => REPLACES.to_string(),
            false => format!("`--checkpoint=FILE` keeps the samples elsewhere, {REPLACES}"),
        };
        match self.subject.refuses(&saved.subject, CALLED) {
            Some(why) if self.places.yields => {
                self.say_begun_anew(path, &why);
                return Ok(None);
            }
            Some(why) => return Err(cannot(why, &otherwise)),
            None => {}
        }
        // What is there of the very picture is not thrown away for a limit or a look that was mistaken, in a film either.
        match refuses(&saved.making) {
            Some(why) => Err(cannot(why, &otherwise)),
            None => {
                self.refuse_loss(path, &saved.making)?;
                self.last.1 = saved.making.mean_samples();
                let from = Amount::of(&saved.making, path);
                if build::same(path) == build::same(&self.places.to) {
                    self.account.to = Some(from.clone());
                    self.judged = saved.making.judged();
                }
                self.account.from = Some(from);
                Ok(Some(saved.making))
            }
        }
    }

    /// Refuses to replace a share by what is none, or by another one.
    fn refuse_share(&self) -> Result<(), Problem> {
        let to = &self.places.to;
        let share =
            head(to).and_then(|head| head.subject.share).filter(|share| Some(*share) != self.subject.share);
        let Some(Share { index, of, samples }) = share else { return Ok(()) };
        let to = to.display();
        Err(Problem::new(format!(
            "`{to}` would be replaced by the checkpoint, and holds share {index}/{of} of {samples} samples"
        ))
        .help(match self.places.yields {
            true => "remove it, or give the frames another name",
            false => "remove it, or name another file: `--checkpoint=FILE`",
        }))
    }

    /// Refuses to replace samples that are kept under the one name by others that are gone on with from the other, unless these
    /// are more of the same.
    fn refuse_loss(&self, from: &Path, making: &Making) -> Result<(), Problem> {
        let to = &self.places.to;
        let Some(head) = head(to).filter(|_| build::same(from) != build::same(to)) else { return Ok(()) };
        let has_more = |kept: [u32; 2]| kept.iter().zip(making.samples()).any(|(kept, own)| *kept > own);
        let why = match self.subject.refuses(&head.subject, CALLED) {
            Some(why) => why,
            None if head.facts.samples.is_some_and(has_more) => {
                format!("it has more samples than `{}`", from.display())
            }
            None => return Ok(()),
        };
        let to = to.display();
        Err(Problem::new(format!("`{to}` would be replaced by the checkpoint: {why}")).help(format!(
            "`--resume={to}` goes on from it, `--checkpoint=FILE` keeps the samples elsewhere"
        )))
    }

    fn say_begun_anew(&self, path: &Path, why: &str) {
        self.context.say(&format!("`{}` is not gone on from: {why}", path.display()));
    }

    /// Keeps the samples if it is time, or if that was asked for.
    pub fn consider(&mut self, making: &Making) {
        let since = (self.last.0.elapsed(), making.mean_samples() - self.last.1);
        // What was asked for is done, whether it was due or not.
        if self.context.interrupt.is_requested() || is_due(self.every, since, self.cost) {
            self.keep(making);
        }
    }

    /// Keeps the samples. Where that fails, what was kept before stays, and the picture goes on.
    pub fn keep(&mut self, making: &Making) {
        let start = Instant::now();
        let kept = self.write(making);
        self.cost = start.elapsed();
        self.last = (Instant::now(), making.mean_samples());
        self.account.lacks = kept.is_err();
        match kept {
            Ok(()) => {
                self.account.to = Some(Amount::of(making, &self.places.to));
                self.judged = making.judged();
            }
            Err(problem) if !self.complained => {
                let problem = problem.help("the samples are not kept; the picture goes on");
                self.context.terminal.warning(&problem);
                self.complained = true;
            }
            Err(_) => {}
        }
    }

    /// Keeps the samples when no more come for now, unless there are none, or they are kept already, with what was decided last:
    /// what is kept then depends on nothing else.
    pub fn finish(&mut self, making: &Making) {
        let kept = self.account.to.as_ref().map_or(0.0, |to| to.mean);
        if making.mean_samples() > kept || kept > 0.0 && self.judged != making.judged() {
            self.keep(making);
        }
    }

    /// What is kept by now, in words.
    pub fn kept(&self) -> Option<String> {
        self.account.kept()
    }

    /// What was there before, and what is kept now.
    pub fn account(self) -> Account {
        self.account
    }

    fn write(&self, making: &Making) -> Result<(), Problem> {
        let to = &self.places.to;
        let facts = saved::judged(self.facts.clone(), making.film(), making.samples());
        let bytes = self.subject.encode(making, &facts);
        let bytes = bytes.map_err(|why| Problem::new(format!("cannot write `{}`: {why}", to.display())))?;
        write(to, &bytes, self.context.interrupt)
    }
}

/// Whether samples are to be kept again, so long and so many samples after they were, where that takes so long.
fn is_due(every: Every, (time, samples): (Duration, f64), cost: Duration) -> bool {
    let wanted = match every {
        Every::Time(every) => time >= every,
        Every::Samples(every) => samples >= f64::from(every),
    };
    wanted && time >= cost.saturating_mul(COST)
}

/// Replaces a file by another that is whole.
fn write(path: &Path, bytes: &[u8], interrupt: &Interrupt) -> Result<(), Problem> {
    let mut aside = Aside::always_beside(path, interrupt)?;
    aside.write(bytes)?;
    aside.finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_is_traced_far_longer_than_it_is_kept() {
        let seconds = Duration::from_secs;
        let due = |every, time, samples, cost| is_due(every, (seconds(time), samples), seconds(cost));
        let minute = Every::Time(seconds(60));
        assert!(due(minute, 60, 0.0, 0) && due(minute, 60, 0.0, 3) && !due(minute, 59, 9.0, 0));
        assert!(!due(minute, 60, 9.0, 25) && !due(minute, 499, 9.0, 25) && due(minute, 500, 9.0, 25));
        let ten = Every::Samples(10);
        assert!(
            due(ten, 0, 10.0, 0) && !due(ten, 900, 9.0, 0) && !due(ten, 19, 10.0, 1) && due(ten, 20, 10.0, 1)
        );
    }
}
