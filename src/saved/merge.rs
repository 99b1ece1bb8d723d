//! Shares of a picture's samples, put together.

use super::{Refused, Saved, Share, Subject, refused};
use crate::output::Facts;
use crate::render::Film;
use crate::scene::Tonemap;

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
        let own = self.share();
        // Its own number is what a share may differ in.
        let expected = Subject { share: Some(Share { index: share.index, ..own }), ..self.subject.clone() };
        let first = self.names.iter().flatten().next().map_or("", String::as_str);
        if let Some(why) = expected.refuses(&next.subject) {
            return refused(format!("does not go with `{first}`: {why}"));
        }
        if let Some(difference) = unlike(&self.facts, &next.facts) {
            return refused(format!("does not go with `{first}`: it differs in {difference}"));
        }
        if next.making.film().scale() != self.film.scale() {
            return refused(format!("does not go with `{first}`: it has another scale"));
        }
        match &mut self.names[share.index as usize - 1] {
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

/// In what a share came about otherwise than the first, such that the picture would depend on which of them is the first.
fn unlike(first: &Facts, other: &Facts) -> Option<String> {
    let stops = |facts: &Facts| facts.stops.map_or("none".to_string(), |stops| stops.to_string());
    let curve = |facts: &Facts| facts.tonemap.map_or("none", Tonemap::word);
    if first.stops != other.stops {
        return Some(format!("its exposure ({}, not {})", stops(other), stops(first)));
    }
    if first.tonemap != other.tonemap {
        return Some(format!("its tonemap ({}, not {})", curve(other), curve(first)));
    }
    let rest = |facts: &Facts| (facts.scene.clone(), facts.seed, facts.software.clone());
    (rest(first) != rest(other)).then(|| "what it says of its scene".to_string())
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
