//! Which frames of a film are to be made: as flags say it, or the scheduler.

use super::super::args::Only;
use super::super::{Problem, shard};
use std::collections::BTreeSet;

/// The numbers of the frames, in order. `variable` gives the value of an environment variable.
pub fn frames(
    only: Option<&Only>,
    of: u32,
    variable: &dyn Fn(&str) -> Option<String>,
) -> Result<Vec<u32>, Problem> {
    let exists = |number: u32| match (1..=of).contains(&number) {
        true => Ok(()),
        false => {
            let problem = Problem::new(format!("there is no frame {number}: the film has {of}"));
            Err(problem.help("frames are counted from 1"))
        }
    };
    match only {
        None => Ok((1..=of).collect()),
        Some(Only::Listed(listed)) => {
            for (first, last) in listed {
                exists(last.unwrap_or(*first).max(*first))?;
            }
            let numbers: BTreeSet<u32> = Only::ranges(listed, of).flatten().collect();
            Ok(numbers.into_iter().collect())
        }
        Some(Only::Auto) => {
            let number = task(variable)?;
            exists(number).map(|()| vec![number])
        }
        Some(Only::AutoOf(runs)) => {
            let number = task(variable)?;
            if *runs > of {
                let problem = Problem::new(format!("{of} frames cannot be divided into {runs} runs"));
                return Err(problem.help("have as many runs as frames, or fewer"));
            }
            if !(1..=*runs).contains(&number) {
                let counted = format!("they are counted from 1 to {runs}");
                return Err(Problem::new(format!("there is no run {number} of {runs}: {counted}")));
            }
            let bound = |run: u32| (u64::from(of) * u64::from(run) / u64::from(*runs)) as u32;
            Ok((bound(number - 1) + 1..=bound(number)).collect())
        }
    }
}

fn task(variable: &dyn Fn(&str) -> Option<String>) -> Result<u32, Problem> {
    shard::task(variable).ok_or_else(|| {
        let problem = Problem::new("no scheduler says which frame this is");
        problem
            .help("`--only auto` asks SLURM_ARRAY_TASK_ID, then JOB_COMPLETION_INDEX; else give `--only 7`")
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ask(only: Only, variables: &[(&str, &str)]) -> Result<Vec<u32>, String> {
        let variable = |name: &str| {
            variables.iter().find(|(known, _)| *known == name).map(|(_, value)| value.to_string())
        };
        frames(Some(&only), 48, &variable).map_err(|problem| problem.message)
    }

    #[test]
    fn ranges_are_put_together() {
        let listed = |ranges: &[(u32, Option<u32>)]| ask(Only::Listed(ranges.to_vec()), &[]);
        assert_eq!(listed(&[(46, None), (1, Some(2)), (2, Some(3))]), Ok(vec![1, 2, 3, 46, 47, 48]));
        for beyond in [(49, None), (40, Some(49)), (49, Some(49))] {
            assert_eq!(listed(&[beyond]), Err("there is no frame 49: the film has 48".into()));
        }
        assert_eq!(frames(None, 3, &|_| None).unwrap(), [1, 2, 3]);
    }

    #[test]
    fn the_scheduler_says_which_frame_it_is() {
        let slurm = |id| [("SLURM_ARRAY_TASK_ID", id)];
        assert_eq!(ask(Only::Auto, &slurm("7")), Ok(vec![7]));
        assert_eq!(ask(Only::Auto, &[("JOB_COMPLETION_INDEX", "0")]), Ok(vec![1]));
        assert!(ask(Only::Auto, &slurm("49")).is_err() && ask(Only::Auto, &slurm("0")).is_err());
        assert!(ask(Only::Auto, &[]).is_err_and(|why| why.contains("no scheduler")));
        let of_five = |run: &'static str| ask(Only::AutoOf(5), &slurm(run)).unwrap();
        let all: Vec<u32> = ["1", "2", "3", "4", "5"].into_iter().flat_map(of_five).collect();
        assert_eq!(all, (1..=48).collect::<Vec<u32>>(), "each frame in one run");
        assert!(ask(Only::AutoOf(49), &slurm("1")).is_err() && ask(Only::AutoOf(5), &slurm("6")).is_err());
    }
}
