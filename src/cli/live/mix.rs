//! A picture whose lamps have become brighter or darker since it was traced, before it is traced anew.

use super::hub::Frame;
use rayon::prelude::*;
use rt_lang::color::Rgb;
use rt_lang::render::light::Source;
use rt_lang::render::shares::Shares;
use rt_lang::render::{Cancelled, Control, Tracer};
use rt_lang::scene::Scene;
use std::sync::Arc;

/// A picture that was done, and how bright its lamps have become since.
pub struct Mix {
    /// The picture.
    pub picture: Arc<Frame>,
    shares: Shares,
    /// Of each of their sources.
    factors: Vec<Rgb>,
}

impl Mix {
    /// Learns how much of a picture is of which lamp. None where that would take too much.
    ///
    /// # Errors
    ///
    /// If the control cancels.
    pub fn learn(tracer: &Tracer, picture: &Arc<Frame>, control: &Control) -> Result<Option<Mix>, Cancelled> {
        let mix = |shares: Shares| {
            let factors = vec![Rgb::ONE; shares.sources().len()];
            Mix { picture: picture.clone(), shares, factors }
        };
        Ok(tracer.shares(control)?.map(mix))
    }

    /// Every lamp counts by one more factor: those of the lights of the scene, then those of its materials.
    pub fn relight(&mut self, scene: &Scene, factors: &[Rgb]) {
        for (all, source) in self.factors.iter_mut().zip(self.shares.sources()) {
            *all *= match source {
                Source::Light(index) => factors[*index as usize],
                Source::Primitive(id) => {
                    let material = scene.primitives[id.0 as usize].material;
                    factors[scene.lights.len() + material.0 as usize]
                }
            };
        }
    }

    /// What the picture shows by now, as [`Frame::pixels`] has it.
    pub fn pixels(&self) -> Vec<[f32; 5]> {
        let [width, _] = self.picture.size;
        let mixed = |(index, [red, green, blue, _, alpha]): (usize, &[f32; 5])| {
            let (x, y) = (index as u32 % width, index as u32 / width);
            let [r, g, b] = self.shares.factor(x, y, &self.factors);
            // How the errors of lamps hang together was not kept.
            [red * r, green * g, blue * b, f32::INFINITY, *alpha]
        };
        self.picture.pixels.par_iter().enumerate().map(mixed).collect()
    }
}
