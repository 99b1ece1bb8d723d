//! Names that are probably meant by others.

use crate::diagnostic::Diagnostic;
use crate::span::Span;
use std::cmp::Reverse;

/// The longest name that a guess is made for.
const MAX_GUESSED: usize = 64;

/// From so many letters on a name may have two slips of typing.
const LONG: usize = 8;

/// So many names are offered where none is certain.
const OFFERED: usize = 3;

/// Up to so many letters another letter makes another word.
const SHORT: usize = 3;

/// The name that another probably means.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(in crate::check) struct Guess<'a> {
    /// What is probably meant.
    pub(in crate::check) name: &'a str,
    /// Whether it is a slip of typing and no other name is as near, so that it can be mended blindly. Another name
    /// that merely lies near would silently make another picture.
    pub(in crate::check) certain: bool,
    /// The nearest names, it first.
    pub(in crate::check) near: Vec<&'a str>,
}

impl Guess<'_> {
    /// Asks whether this was meant; `sign` is what stands before it.
    pub(in crate::check) fn ask(self, diagnostic: Diagnostic, span: Span, sign: &str) -> Diagnostic {
        let diagnostic = diagnostic.help(format!("did you mean `{sign}{}`?", self.name));
        if self.certain {
            return diagnostic.fix(span, self.name);
        }
        let offer = |diagnostic: Diagnostic, name: &&str| {
            diagnostic.offer(format!("replace it with `{sign}{name}`"), vec![(span, name.to_string())])
        };
        self.near.iter().fold(diagnostic, offer)
    }
}

/// The candidate that is probably meant: at most a third of the letters away. Of a name of one letter another
/// letter says nothing.
pub(in crate::check) fn closest<'a>(name: &str, candidates: &[&'a str]) -> Option<Guess<'a>> {
    let length = name.chars().count();
    let limit = match length {
        0 | 1 => 0,
        // Comparing takes time with the square of the length.
        2..=MAX_GUESSED => (length / 3).max(1),
        _ => return None,
    };
    let lower = name.to_lowercase();
    let near = candidates.iter().filter(|candidate| candidate.chars().count().abs_diff(length) <= limit);
    let near = near.map(|candidate| {
        let distance = strsim::damerau_levenshtein(name, candidate);
        // Another case of the same letters is the nearest miss there is; first letters are seldom wrong.
        let distance = if candidate.to_lowercase() == lower { 0 } else { distance };
        (distance, name.chars().next() != candidate.chars().next(), *candidate)
    });
    let mut near: Vec<(usize, bool, &str)> = near.filter(|(distance, ..)| *distance <= limit).collect();
    // Of two that are as far, the one with all the letters that were written is the likelier.
    let rank = |(distance, other_start, candidate): &(usize, bool, &'a str)| {
        (*distance, *other_start, Reverse(is_within(&lower, candidate)))
    };
    near.sort_by_key(rank);
    let (distance, _, found) = near.first().copied()?;
    let alone = near.iter().all(|(other, _, name)| *other > distance || *name == found);
    let mut names: Vec<&str> = vec![];
    for (_, _, name) in near {
        if names.len() < OFFERED && !names.contains(&name) {
            names.push(name);
        }
    }
    Some(Guess { name: found, certain: alone && is_slip(name, found, distance), near: names })
}

/// Whether names that differ in so many letters are one, with a slip of typing: a letter left out, doubled, taken for
/// another within the word, or exchanged with the next.
fn is_slip(name: &str, meant: &str, distance: usize) -> bool {
    let length = name.chars().count();
    let digits = |name: &str| name.chars().filter(char::is_ascii_digit).collect::<String>();
    let ends = |name: &str| (name.chars().next(), name.chars().next_back());
    let sorted = |name: &str| {
        let mut letters: Vec<char> = name.chars().collect();
        letters.sort_unstable();
        letters
    };
    // `big2` for `big3` is another name.
    if digits(name) != digits(meant) {
        return false;
    }
    let replaced = length == meant.chars().count() && sorted(name) != sorted(meant);
    match distance {
        0 => true,
        // `hall` for `tall` and `hsv` for `hsl` are other words.
        1 if replaced => length > SHORT && ends(name) == ends(meant),
        1 => true,
        2 => length >= LONG && ends(name) == ends(meant),
        _ => false,
    }
}

/// Whether the letters of a name are all in another, in this order.
fn is_within(name: &str, other: &str) -> bool {
    let mut letters = other.chars();
    name.chars().all(|letter| letters.any(|other| other == letter))
}

#[cfg(test)]
mod tests {
    use super::{Guess, closest};

    #[test]
    fn only_what_is_clearly_nearest_is_certain() {
        let certain = |name, candidates: &[&'static str]| {
            closest(name, candidates).map(|Guess { name, certain, .. }| (name, certain))
        };
        assert_eq!(certain("raduis", &["radius", "at"]), Some(("radius", true)));
        assert_eq!(certain("Radius", &["radius"]), Some(("radius", true)));
        assert_eq!(certain("sample", &["samples"]), Some(("samples", true)));
        assert_eq!(certain("hyprboliod", &["hyperboloid"]), Some(("hyperboloid", true)));
        assert_eq!(certain("big3", &["big1", "big2"]), Some(("big1", false)));
        assert_eq!(certain("tall", &["wall", "hall"]), Some(("wall", false)));
        assert_eq!(certain("tall", &["hall"]), Some(("hall", false)));
        assert_eq!(certain("atan", &["atan2"]), Some(("atan2", false)));
        assert_eq!(certain("hsl", &["hsv"]), Some(("hsv", false)));
        assert_eq!(certain("m2m", &["mm"]), Some(("mm", false)));
        assert_eq!(certain("x", &["y"]), None);
        let near = closest("tall", &["ball", "tail", "hall", "box"]).map(|guess| guess.near);
        assert_eq!(near, Some(vec!["tail", "ball", "hall"]));
    }
}
