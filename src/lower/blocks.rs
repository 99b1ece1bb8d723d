//! How the picture is taken: the one camera, lens and render block, and what they say of its size and samples.

use super::{Lowering, MAX_PIXELS, errors, plain};
use crate::eval::{Thing, Things};
use crate::scene::{Target, Tonemap, Trace};
use crate::schema::{DEFAULT_SAMPLES, camera, lens, render};

/// The blocks that say how the picture is taken.
#[derive(Default)]
pub(super) struct Blocks<'a> {
    pub(super) camera: Option<&'a Thing<'a>>,
    /// Cameras that do not take the picture and are looked at all the same.
    pub(super) others: Vec<&'a Thing<'a>>,
    pub(super) lens: Option<&'a Thing<'a>>,
    pub(super) render: Option<&'a Thing<'a>>,
}

impl<'a> Lowering<'a> {
    /// Finds the one camera, lens and render block.
    pub(super) fn blocks(&mut self) -> Blocks<'a> {
        let all = self.written;
        let of = |kind| all.iter().map(|(_, thing)| thing).filter(move |thing| thing.made.kind() == kind);
        let mut blocks = Blocks::default();
        for (kind, place) in [(render::KIND, &mut blocks.render), (lens::KIND, &mut blocks.lens)] {
            for thing in of(kind) {
                match place {
                    Some(first) => {
                        let diagnostic =
                            errors::second(kind.get().name, thing.made.span(), first.made.span());
                        self.out.diagnostics.push(diagnostic);
                    }
                    None => *place = Some(thing),
                }
            }
        }
        let cameras: Vec<(usize, &Thing)> = all
            .iter()
            .filter(|(_, thing)| thing.made.kind() == camera::KIND)
            .map(|(index, thing)| (*index, thing))
            .collect();
        blocks.camera = self.choose_camera(&cameras, blocks.render);
        if self.overrides.every_camera {
            let taken = blocks.camera.map(|camera| camera.made.span());
            let others = cameras.iter().map(|(_, camera)| *camera);
            blocks.others = others.filter(|camera| Some(camera.made.span()) != taken).collect();
        }
        if let (Some(lens), [first, _, ..]) = (blocks.lens, &cameras[..]) {
            self.report(errors::lens_of_which(lens.made.span(), first.1.made.span()));
        }
        blocks
    }

    fn choose_camera(
        &mut self,
        cameras: &[(usize, &'a Thing<'a>)],
        render: Option<&Thing>,
    ) -> Option<&'a Thing<'a>> {
        let names: Vec<&str> =
            cameras.iter().filter_map(|(_, camera)| camera.name()).map(|name| name.as_str()).collect();
        if let Some(wanted) = &self.overrides.camera {
            let found = cameras.iter().find(|(_, camera)| camera.name().is_some_and(|name| name == wanted));
            if found.is_none() && !self.things.incomplete {
                let place = cameras.first().map(|(_, camera)| camera.made.span());
                self.report(errors::no_such_camera(wanted, &names, place));
            }
            return found.map(|(_, camera)| *camera);
        }
        if let Some((id, _)) = render.and_then(|render| render.made.given(render::CAMERA)) {
            let place = self.things.place(id)?;
            return cameras.iter().find(|(index, _)| place.contains(index)).map(|(_, camera)| *camera);
        }
        // What has an error may be what chooses.
        let unknown = self.things.incomplete || render.is_some_and(|render| !render.made.is_sound());
        if let [_, (_, second), ..] = cameras
            && !unknown
            && !(self.overrides.every_camera && names.len() == cameras.len())
        {
            self.report(errors::which_camera(second.made.span(), cameras[0].1.made.span(), &names));
        }
        cameras.first().map(|(_, camera)| *camera)
    }

    /// Width and height in pixels; none where there are too many.
    pub(super) fn size(&mut self, blocks: &Blocks) -> Option<[u32; 2]> {
        let given = blocks.render.and_then(|thing| thing.made.given(render::SIZE));
        let size = match (self.overrides.size, &given) {
            (Some(size), _) => size,
            (None, Some((size, _))) => *size,
            (None, None) => default_size(self.things),
        };
        let pixels = u64::from(size[0]) * u64::from(size[1]);
        if pixels > MAX_PIXELS {
            self.report(errors::too_many_pixels(size, given.map(|(_, span)| span)));
            return None;
        }
        Some(size)
    }

    pub(super) fn trace(&mut self, blocks: &Blocks, size: [u32; 2]) -> (Trace, Tonemap) {
        let plain = plain(render::KIND);
        let made = blocks.render.map_or(plain.fields(), |thing| thing.made);
        let samples = made.given(render::SAMPLES);
        let noise = made.given(render::NOISE);
        self.out.marks.samples = samples.map(|(_, span)| span);
        let own = self.overrides.noise.is_none().then_some(noise).flatten();
        self.out.places.noise = own.map(|(_, span)| span);
        self.out.places.bounces = made.given(render::BOUNCES).map(|(_, span)| span);
        let target = match (
            self.overrides.samples.or(samples.map(|(n, _)| n as u32)),
            self.overrides.noise,
            own,
        ) {
            (_, Some(noise), _) | (None, None, Some((noise, _))) => Target::Noise(noise),
            (Some(samples), None, _) => Target::Samples(samples),
            (None, None, None) if self.overrides.limited => Target::Samples(u32::MAX),
            (None, None, None) => {
                self.out.notes.push(format!(
                    "no samples or noise: {DEFAULT_SAMPLES} samples a pixel, as `render {{ samples: {DEFAULT_SAMPLES} }}`"
                ));
                Target::Samples(DEFAULT_SAMPLES)
            }
        };
        let trace = Trace {
            size,
            target,
            bounces: self.things.read(made, render::BOUNCES) as u32,
            indirect: self.things.read(made, render::INDIRECT),
            seed: self.overrides.seed.unwrap_or(self.things.read(made, render::SEED) as u64),
            filter: self.things.read(made, render::FILTER),
            background: self.things.read(made, render::BACKGROUND),
        };
        let tonemap = self.overrides.tonemap.unwrap_or_else(|| self.things.read(made, render::TONEMAP));
        (trace, tonemap)
    }
}

fn default_size(things: &Things) -> [u32; 2] {
    things.read(plain(render::KIND).fields(), render::SIZE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::schema::{Preset, sphere};

    #[test]
    fn blocks_can_stand_with_nothing_in_them() {
        for kind in [render::KIND, camera::KIND] {
            assert!(kind.fields().all(|field| field.default != Preset::Required), "{}", kind.get().name);
        }
        assert!(sphere::KIND.fields().any(|field| field.default == Preset::Required));
    }
}
