//! Shares of a picture's samples, put together.

use super::{Head, Refused, Saved, Share, Subject, refused};
use crate::output::Facts;
use crate::render::Film;
use crate::scene::{Tonemap, identity::difference};
use std::collections::BTreeSet;

/// A picture of which some shares are there.
pub struct Merging {
    /// What the first is of.
    subject: Subject,
    facts: Facts,
    /// The sums of all of them.
    film: Film,
    /// The file of each share, by its number less one.
    names: Vec<Option<String>>,
}

impl Merging {
    /// Begins with a share from a file of this name.
    pub fn new(name: &str, first: Saved) -> Result<Merging, Refused> {
        let share = finished(&first)?;
        let mut names = vec![None; share.of as usize];
        names[share.index as usize - 1] = Some(name.to_string());
        let Saved { subject, making, facts } = first;
        Ok(Merging { subject, facts, film: making.into_film(), names })
    }

    /// Adds a share from a file of this name.
    pub fn add(&mut self, name: &str, next: &Saved) -> Result<(), Refused> {
        let share = finished(next)?;
        let own = (&self.subject, &self.facts, self.film.scale());
        if let Some(why) = unlike(own, (&next.subject, &next.facts, next.making.film().scale())) {
            let mut known = self.names.iter().flatten();
            let first = known.next().map_or("", String::as_str);
            let more = match known.count() {
                0 => String::new(),
                more => format!(" and {more} more"),
            };
            return refused(format!("does not go with `{first}`{more}: {why}"));
        }
        match &mut self.names[share.index as usize - 1] {
            Some(known) if known == name => refused("is given twice"),
            Some(known) => refused(format!("is share {} of {}, and so is `{known}`", share.index, share.of)),
            place => {
                *place = Some(name.to_string());
                self.film.merge(next.making.film());
                Ok(())
            }
        }
    }

    /// The numbers of the shares that are not there.
    pub fn missing(&self) -> Vec<u32> {
        let missing = self.names.iter().zip(1..).filter(|(name, _)| name.is_none());
        missing.map(|(_, index)| index).collect()
    }

    /// One of its shares.
    pub fn share(&self) -> Share {
        self.subject.share.unwrap_or(Share { index: 1, of: 1, samples: 1 })
    }

    /// What the shares are of; which of them, of the first.
    pub fn subject(&self) -> &Subject {
        &self.subject
    }

    /// How the first of them came about.
    pub fn facts(&self) -> &Facts {
        &self.facts
    }

    /// The sums of the shares that are there.
    pub fn film(&self) -> &Film {
        &self.film
    }
}

/// In which order shares are to be put together, by what the heads of their files say, so that those are first of which most are
/// there, finished ones above all, and each once: then it is the odd ones that do not go with the others.
///
/// # Errors
///
/// With the first of each, where there are as many of one picture as of another.
pub fn most_first(heads: &[Option<Head>]) -> Result<Vec<usize>, [usize; 2]> {
    let mut groups: Vec<Vec<usize>> = vec![];
    for (at, head) in heads.iter().enumerate() {
        let Some(head) = head.as_ref().filter(|head| head.subject.share.is_some()) else { continue };
        let kin = |group: &&mut Vec<usize>| {
            let first = heads[group[0]].as_ref();
            first.is_some_and(|first| unlike(first.parts(), head.parts()).is_none())
        };
        match groups.iter_mut().find(kin) {
            Some(group) => group.push(at),
            None => groups.push(vec![at]),
        }
    }
    let weight = |group: &Vec<usize>| {
        let members = group.iter().filter_map(|at| heads[*at].as_ref());
        let distinct = |indices: BTreeSet<u32>| indices.len();
        let index = |head: &Head| head.subject.share.map(|share| share.index);
        let finished = members.clone().filter(|head| head.is_finished()).filter_map(index);
        (distinct(finished.collect()), distinct(members.filter_map(index).collect()))
    };
    let mut groups: Vec<_> = groups.into_iter().map(|group| (weight(&group), group)).collect();
    // Of as many the first ones stay first.
    groups.sort_by_key(|(weight, _)| std::cmp::Reverse(*weight));
    match groups.as_slice() {
        [(one, first), (other, next), ..] if one == other => Err([first[0], next[0]]),
        _ => {
            let mut order = groups.into_iter().next().map(|(_, first)| first).unwrap_or_default();
            let mut is_first = vec![false; heads.len()];
            order.iter().for_each(|at| is_first[*at] = true);
            order.extend((0..heads.len()).filter(|at| !is_first[*at]));
            Ok(order)
        }
    }
}

impl Head {
    /// Whether it says that it is a share that has all its samples.
    fn is_finished(&self) -> bool {
        let wanted = self.subject.share.map(|share| share.range().len() as u32);
        wanted.is_some_and(|wanted| self.facts.samples == Some([wanted; 2]))
    }

    fn parts(&self) -> Parts<'_> {
        (&self.subject, &self.facts, self.scale)
    }
}

/// What tells whether a share goes with another: what it is of, how it came about, and the scale of its sums.
type Parts<'s> = (&'s Subject, &'s Facts, f64);

/// Why another share does not go with one, such that the picture would be another or depend on which of them is the first.
fn unlike((own, facts, scale): Parts, (other, others, other_scale): Parts) -> Option<String> {
    const CALLED: &str = "this share";
    let expected = Subject { share: other.share, ..own.clone() };
    if let Some(why) = expected.refuses(other, CALLED) {
        return Some(why);
    }
    // Its own number is what a share may differ in.
    let division = |subject: &Subject| {
        subject.share.map(|Share { samples, of, .. }| format!("{samples} samples in {of} shares"))
    };
    let divisions = division(own).zip(division(other));
    if let Some((own, other)) = divisions.filter(|(own, other)| own != other) {
        return Some(format!("its picture is of {other}, and that one of {own}"));
    }
    let stops = |facts: &Facts| facts.stops.map_or("none".to_string(), |stops| stops.to_string());
    let curve = |facts: &Facts| facts.tonemap.map_or("none", Tonemap::word);
    let shown = |flag: &str, own: &str, other: &str| {
        let difference = difference(&format!("`--{flag} {own}`"), CALLED, other);
        Some(format!("it is shown otherwise: {difference}"))
    };
    if facts.stops != others.stops {
        return shown("exposure", &stops(facts), &stops(others));
    }
    if facts.tonemap != others.tonemap {
        return shown("tonemap", curve(facts), curve(others));
    }
    let rest = |facts: &Facts| (facts.scene.clone(), facts.seed, facts.software.clone());
    (rest(facts) != rest(others) || scale != other_scale).then(|| "it is of another scene".to_string())
}

/// Which share it is, if it is one and has all its samples.
fn finished(saved: &Saved) -> Result<Share, Refused> {
    let Some(share) = saved.subject.share else {
        return refused("is no share of a picture: it is a checkpoint");
    };
    let wanted = share.range().len() as u32;
    match saved.making.samples() {
        _ if saved.making.start() != share.range().start => refused("has other samples than its share"),
        [least, most] if (least, most) == (wanted, wanted) => Ok(share),
        [least, most] if most <= wanted => {
            refused(format!("is not finished: it has {least} of its {wanted} samples a pixel"))
        }
        _ => refused("has other samples than its share"),
    }
}
