//! Which share of a picture's samples is to be made: as flags say it, or the scheduler.

use super::Problem;
use super::args::{Build, Shard};
use super::target::Target;
use rt_lang::output::Format;
use rt_lang::saved::Share;

/// The share of so many samples that a flag means. `variable` gives the value of an environment variable.
pub fn share(
    shard: Shard,
    samples: u32,
    variable: &dyn Fn(&str) -> Option<String>,
) -> Result<Share, Problem> {
    let (index, of) = match shard {
        Shard::Given(index, of) => (index, of),
        Shard::Auto => array(variable)?,
        Shard::AutoOf(of) => (index(variable)?, of),
    };
    let share = Share { index, of, samples };
    match share {
        _ if !(1..=of).contains(&index) => {
            Err(Problem::new(format!("there is no share {index} of {of}: they are counted from 1 to {of}")))
        }
        share if share.is_one() => Ok(share),
        _ => Err(Problem::new(format!("{samples} samples a pixel cannot be divided into {of} shares"))
            .help("ask for more samples, or for fewer shares")),
    }
}

/// A share has so many samples and nothing else, and is an EXR.
pub fn refuse_what_shares_cannot(arguments: &Build, targets: &[Target]) -> Result<(), Problem> {
    if arguments.keeping.shard.is_none() {
        return Ok(());
    }
    let fixed = "every share must know its samples before: give `--samples N`";
    let idle = match arguments {
        Build { halting, .. } if halting.time.is_some() => Some(("--time", fixed)),
        Build { taking, .. } if taking.noise.is_some() => Some(("--noise", fixed)),
        Build { aov, .. } if !aov.is_empty() => {
            Some(("--aov", "make these channels apart, with a few samples"))
        }
        Build { feedback: true, .. } => Some(("--feedback", "it is of the whole picture: ask for it apart")),
        _ => None,
    };
    if let Some((flag, help)) = idle {
        return Err(Problem::new(format!("`--shard` and `{flag}` do not go together")).help(help));
    }
    if targets.iter().all(|target| target.format == Format::Exr) {
        return Ok(());
    }
    let problem = Problem::new("a share of a picture is an EXR, which holds its exact sums");
    Err(problem.help("say where it goes: `-o part1.exr`"))
}

/// The share that is the task of a Slurm job array. Part of an array has not as many tasks as there are shares, so it must be
/// a whole one, from 1 on.
fn array(variable: &dyn Fn(&str) -> Option<String>) -> Result<(u32, u32), Problem> {
    let task = |name: &str| number(variable, &format!("SLURM_ARRAY_TASK_{name}"));
    let numbers = [task("ID")?, task("COUNT")?, task("MIN")?, task("MAX")?];
    let help =
        "say how many shares there are: `--shard auto/N` takes only the first number from the scheduler";
    match numbers {
        // One task alone is far more often what is left of many.
        [Some(_), Some(1), ..] => Err(Problem::new(
            "this is a Slurm job array of one task: `--shard auto` cannot tell how many shares there are",
        )
        .help(help)),
        [Some(id), Some(count), Some(1), Some(max)] if max == count => Ok((id, count)),
        [Some(_), Some(count), ..] => {
            let which = format!("this is a Slurm job array of {count} tasks, and not all from 1 to {count}");
            Err(Problem::new(format!("{which}: `--shard auto` cannot tell how many shares there are"))
                .help(help))
        }
        _ if number(variable, KUBERNETES)?.is_some() => Err(Problem::new(
            "Kubernetes does not say how many shares there are, so `--shard auto` cannot tell",
        )
        .help("say it, as in the job's `completions`: `--shard auto/N`")),
        _ => {
            Err(Problem::new("`--shard auto` is for a task of a Slurm job array, and this is none")
                .help(help))
        }
    }
}

/// The number of the share by the index of the task.
fn index(variable: &dyn Fn(&str) -> Option<String>) -> Result<u32, Problem> {
    task(variable)?.ok_or_else(|| {
        let problem = Problem::new("no scheduler says which share this is");
        problem.help(
            "`--shard auto/N` asks SLURM_ARRAY_TASK_ID, then JOB_COMPLETION_INDEX; else give `--shard I/N`",
        )
    })
}

/// Where Slurm says which task this is.
const SLURM: &str = "SLURM_ARRAY_TASK_ID";
/// Where Kubernetes does.
const KUBERNETES: &str = "JOB_COMPLETION_INDEX";

/// The number of the task, as a scheduler says it: that of Slurm as it is, that of Kubernetes, which counts from 0, plus 1.
pub fn task(variable: &dyn Fn(&str) -> Option<String>) -> Result<Option<u32>, Problem> {
    if let Some(id) = number(variable, SLURM)? {
        return Ok(Some(id));
    }
    let Some(index) = number(variable, KUBERNETES)? else { return Ok(None) };
    index.checked_add(1).map(Some).ok_or_else(|| no_number(KUBERNETES, &index.to_string()))
}

/// The number that a variable holds; none where it is not set. What is no number comes from something that went wrong, and
/// must not be taken for another share.
fn number(variable: &dyn Fn(&str) -> Option<String>, name: &str) -> Result<Option<u32>, Problem> {
    let Some(value) = variable(name) else { return Ok(None) };
    value.trim().parse().map(Some).map_err(|_| no_number(name, &value))
}

fn no_number(name: &str, value: &str) -> Problem {
    let value: String = value.escape_debug().take(40).collect();
    Problem::new(format!("{name} is `{value}`, which is not the number of a task"))
        .help("the scheduler sets it; without one, take it out of the environment")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ask(shard: Shard, variables: &[(&str, &str)]) -> Result<(u32, u32), String> {
        let variable = |name: &str| {
            variables.iter().find(|(known, _)| *known == name).map(|(_, value)| value.to_string())
        };
        share(shard, 64, &variable).map(|share| (share.index, share.of)).map_err(|problem| problem.message)
    }

    fn slurm<'a>(id: &'a str, count: &'a str, min: &'a str, max: &'a str) -> [(&'static str, &'a str); 4] {
        [
            ("SLURM_ARRAY_TASK_ID", id),
            ("SLURM_ARRAY_TASK_COUNT", count),
            ("SLURM_ARRAY_TASK_MIN", min),
            ("SLURM_ARRAY_TASK_MAX", max),
        ]
    }

    #[test]
    fn the_scheduler_says_which_share_it_is() {
        assert_eq!(ask(Shard::Given(2, 4), &[]), Ok((2, 4)));
        assert_eq!(ask(Shard::Auto, &slurm("3", "4", "1", "4")), Ok((3, 4)));
        // A lost one, made again alone.
        let again = slurm("3", "1", "3", "3");
        for alone in [&again, &slurm("1", "1", "1", "1")] {
            assert!(ask(Shard::Auto, alone).is_err_and(|why| why.contains("cannot tell")));
        }
        assert_eq!(ask(Shard::AutoOf(4), &again), Ok((3, 4)));
        assert_eq!(ask(Shard::AutoOf(4), &[("JOB_COMPLETION_INDEX", "0")]), Ok((1, 4)));
        assert!(ask(Shard::AutoOf(4), &[("JOB_COMPLETION_INDEX", "4")]).is_err());
        assert!(ask(Shard::Auto, &slurm("0", "4", "0", "3")).is_err());
        assert!(ask(Shard::Auto, &[]).is_err_and(|why| why.contains("this is none")));
        assert!(ask(Shard::Given(1, 65), &[]).is_err_and(|why| why.contains("cannot be divided")));
    }

    #[test]
    fn what_is_no_number_is_named_and_not_passed_over() {
        let index = ("JOB_COMPLETION_INDEX", "1");
        for wrong in ["x", "-1", "", "4294967296", "1.5"] {
            let id = ("SLURM_ARRAY_TASK_ID", wrong);
            for shard in [Shard::Auto, Shard::AutoOf(2)] {
                let said = ask(shard, &[id, index]).unwrap_err();
                assert!(
                    said.contains("SLURM_ARRAY_TASK_ID") && said.contains(&format!("`{wrong}`")),
                    "{said}"
                );
            }
        }
        let mut count = slurm("1", "4", "1", "4");
        count[1].1 = "four";
        assert!(ask(Shard::Auto, &count).is_err_and(|why| why.contains("SLURM_ARRAY_TASK_COUNT")));
        let last = [("JOB_COMPLETION_INDEX", "4294967295")];
        assert!(ask(Shard::AutoOf(4), &last).is_err_and(|why| why.contains("4294967295")));
        assert!(ask(Shard::Auto, &[index]).is_err_and(|why| why.contains("Kubernetes")));
    }
}
