//! The camera: where it stands, what it looks at, and its lens.

use super::blocks::Blocks;
use super::{Extent, Lowering, Marks, errors, shape::unit};
use crate::diagnostic::Diagnostic;
use crate::eval::{Aim, Fields, Focus, Made, ThingId};
use crate::math::{DVec2, DVec3, atan2, sin, tan};
use crate::scene::shape::Bounds;
use crate::scene::{Camera, Projection};
use crate::schema::{Category, DEFAULT_FOV, camera, lens};
use crate::span::Span;

/// From the middle of the picture towards a camera that was not placed: a three-quarter view.
const THREE_QUARTER: DVec3 = DVec3::new(0.55, 0.42, 1.0);

/// Room left around what a placed camera frames.
const MARGIN: f64 = 1.08;

/// The least radius that is framed, as a share of its distance from the origin.
const ROUNDED: f64 = 1e-12;

/// The greatest cosine between two unit vectors that counts as a right angle: rounding.
const UPRIGHT: f64 = 2e-15;

/// What a camera that leaves open where it stands, or what it looks at, takes for it.
#[derive(Clone, Copy, Debug)]
pub struct Vantage {
    /// Where it stands.
    pub from: DVec3,
    /// What it looks at.
    pub look: DVec3,
    /// Whether either was chosen for the user.
    pub chosen: bool,
}

impl Lowering<'_> {
    /// Finds the cameras that do not take the picture, where they are looked at, and reports what is wrong with them.
    pub(super) fn other_cameras(&mut self, blocks: &Blocks, size: Option<[u32; 2]>) {
        let chosen = self.out.notes.len();
        for camera in &blocks.others {
            let other = Blocks { camera: Some(camera), others: vec![], ..*blocks };
            if let Some((camera, _)) = self.camera(&other, size) {
                let marks = Marks { lights: vec![], ..self.out.marks.clone() };
                self.out.others.push((camera, marks));
            }
        }
        self.out.notes.truncate(chosen);
    }

    /// The camera, and the exposure it asks for; none where something is wrong.
    pub(super) fn camera(
        &mut self,
        blocks: &Blocks,
        size: Option<[u32; 2]>,
    ) -> Option<(Camera, Option<f64>)> {
        let plain = super::plain(camera::KIND);
        let made = blocks.camera.map_or(plain.fields(), |thing| thing.made);
        if !made.is_sound() {
            return None;
        }
        let lens = self.lens(made, blocks)?;
        let (projection, half_width) = match made.given(camera::WIDTH) {
            Some((_, width)) if lens.is_some() => {
                // Of one inside the camera it was said where the two fields stand.
                if let Some(lens) = blocks.lens {
                    self.report(errors::lens_of_parallel(lens.made.span(), width));
                }
                return None;
            }
            Some((width, _)) => (Projection::Orthographic, 0.5 * width),
            None => {
                (Projection::Perspective, tan(0.5 * self.fov(made, lens.as_ref().map(|lens| lens.fields()))?))
            }
        };
        let [width, height] = size.unwrap_or([4, 3]).map(f64::from);
        let half_extent = DVec2::new(half_width, half_width * height / width);

        self.out.marks.camera = blocks.camera.map(|thing| thing.made.span());
        self.out.marks.from = made.given(camera::FROM).map(|(_, span)| span);
        self.out.marks.look = made.given(camera::LOOK).map(|(_, span)| span);

        let (center, radius) = self.middle();
        let vantage = self.overrides.vantage;
        let look = match (made.given(camera::LOOK), vantage) {
            (Some((aim, span)), _) => self.aim(aim, span)?,
            (None, Some(Vantage { look, .. })) => look,
            (None, None) => center,
        };
        let position = match (made.given(camera::FROM), vantage) {
            (Some((from, _)), _) => from,
            (None, Some(Vantage { from, .. })) => from,
            (None, None) => {
                let away = match projection {
                    Projection::Perspective => radius / sin(atan2(half_extent.min_element(), 1.0)),
                    // Far enough for everything to be in front; the width was chosen.
                    Projection::Orthographic => radius + look.distance(center),
                };
                let position = look + THREE_QUARTER.normalize() * (MARGIN * away);
                self.say_placed(blocks.camera.is_some(), position, look);
                position
            }
        };
        if !(position.is_finite() && look.is_finite()) {
            self.report(errors::beyond_view(made.span()));
            return None;
        }
        let place = made.given(camera::FROM).map_or(made.span(), |(_, span)| span);
        let Some(forward) = unit(look - position) else {
            let look_place = made.given(camera::LOOK).map(|(_, span)| span);
            self.report_view(made, errors::looks_at_itself(place, look_place));
            return None;
        };
        let (right, up) = self.upright(made, forward)?;
        let (lens_radius, focus) = match &lens {
            Some(lens) => self.opening(made, lens.fields(), position, forward, look)?,
            None => (0.0, 1.0),
        };
        self.out.vantage = Some(Vantage { from: position, look, chosen: is_chosen(made) });
        if self.overrides.exposure.is_none() {
            self.out.places.exposure = made.given(camera::EXPOSURE).map(|(_, span)| span);
        }
        let camera = Camera { projection, position, right, up, forward, half_extent, lens_radius, focus };
        Some((camera, self.things.read(made, camera::EXPOSURE)))
    }

    /// The camera's own lens, or the one at the top level.
    fn lens(&mut self, made: Fields, blocks: &Blocks) -> Option<Option<std::rc::Rc<Made>>> {
        match (made.given(camera::LENS), blocks.lens) {
            (Some((_, first)), Some(second)) => {
                self.report(errors::second("lens", second.made.span(), first));
                None
            }
            (Some((lens, _)), None) => Some(Some(lens)),
            (None, Some(lens)) if !lens.made.is_sound() => None,
            (None, lens) => Some(lens.map(|thing| thing.made.keep())),
        }
    }

    fn fov(&mut self, made: Fields, lens: Option<Fields>) -> Option<f64> {
        let focal = lens.and_then(|lens| lens.given(lens::FOCAL));
        match (made.given(camera::FOV), focal) {
            (Some((_, fov)), Some((_, focal))) => {
                self.report(errors::fov_and_focal(fov, focal));
                None
            }
            (Some((fov, _)), None) => Some(fov),
            (None, Some((focal, span))) => {
                let sensor = self.things.read(lens?, lens::SENSOR);
                let fov = 2.0 * atan2(sensor, 2.0 * focal);
                if !camera::KIND.field(camera::FOV.index(camera::KIND)).range.contains(fov) {
                    self.report(errors::too_wide(span));
                    return None;
                }
                Some(fov)
            }
            (None, None) => Some(DEFAULT_FOV),
        }
    }

    /// The middle of everything that has an end, and the radius of a ball around it.
    fn middle(&self) -> (DVec3, f64) {
        let boxes = |lamps: bool| {
            self.extents.iter().fold(Bounds::EMPTY, |all, extent| match extent {
                Extent::Box(bounds) => all.union(*bounds),
                Extent::Lamp(bounds) if lamps => all.union(*bounds),
                _ => all,
            })
        };
        let seen = boxes(false);
        let all = if seen.is_empty() { boxes(true) } else { seen };
        match all.is_empty() {
            true => (DVec3::ZERO, 1.0),
            false => {
                let (center, radius) = (all.center(), 0.5 * all.size().length());
                // From a point one stands away, and from what is hardly more, so far out, that rounding makes it one.
                let least = (ROUNDED * center.abs().max_element()).max(f64::MIN_POSITIVE);
                (center, if radius == 0.0 { least.max(1.0) } else { radius.max(least) })
            }
        }
    }

    /// Reports what is wrong with where a camera stands or looks, unless that was chosen by what an error keeps from being known.
    fn report_view(&mut self, made: Fields, diagnostic: Diagnostic) {
        let is_known = || !self.things.incomplete && !(0..self.extents.len()).any(|i| self.is_unknown(i));
        if !is_chosen(made) || is_known() {
            self.report(diagnostic);
        }
    }

    pub(super) fn aim(&mut self, aim: Aim, span: Span) -> Option<DVec3> {
        match aim {
            Aim::Point(point) => Some(point),
            Aim::Thing(id) => self.center(id, span),
        }
    }

    /// The centre of the bounds of a thing or group. Of what has an error nothing more is said.
    fn center(&mut self, id: ThingId, span: Span) -> Option<DVec3> {
        let range = self.things.place(id)?;
        if range.clone().any(|index| self.is_unknown(index)) {
            return None;
        }
        let mut bounds = Bounds::EMPTY;
        for extent in &self.extents[range] {
            match extent {
                Extent::Box(part) | Extent::Lamp(part) => bounds = bounds.union(*part),
                Extent::Endless | Extent::Nowhere => {}
            }
        }
        if bounds.is_empty() {
            // What came to nothing may have stood there.
            if !self.things.incomplete {
                self.report(errors::no_middle(span));
            }
            return None;
        }
        Some(bounds.center())
    }

    /// Whether an error keeps it from being known where a thing is.
    fn is_unknown(&self, index: usize) -> bool {
        let thing = self.things.get(index);
        let shape = thing.made.kind().get().category == Category::Shape && !thing.hidden;
        !thing.made.is_sound() || shape && matches!(self.extents[index], Extent::Nowhere)
    }

    /// The unit vectors to the right and up in the picture.
    fn upright(&mut self, made: Fields, forward: DVec3) -> Option<(DVec3, DVec3)> {
        let given = made.given(camera::UP);
        let up = self.things.read(made, camera::UP);
        let right = unit(up).and_then(|up| parallel_free(forward, up));
        let right = match (right, given) {
            (Some(right), _) => Some(right),
            (None, Some((_, span))) => {
                self.report_view(made, errors::up_along_view(span));
                None
            }
            // Straight up or down, as on a map: north, −z, is at the top.
            (None, None) => parallel_free(forward, DVec3::NEG_Z),
        }?;
        // One that already stands upright is kept, so that a camera that is written out and read again keeps its
        // bits. To the right is then the same function of the two in either case.
        let up = match unit(up).filter(|up| up.dot(forward).abs() <= UPRIGHT) {
            Some(up) => up,
            None => unit(right.cross(forward))?,
        };
        Some((unit(forward.cross(up))?, up))
    }

    /// Radius of the lens, and the distance that is sharp.
    fn opening(
        &mut self,
        made: Fields,
        lens: Fields,
        from: DVec3,
        forward: DVec3,
        look: DVec3,
    ) -> Option<(f64, f64)> {
        let focus = lens.given(lens::FOCUS);
        let distance = match focus {
            Some((Focus::Distance(distance), _)) => distance,
            Some((Focus::Aim(aim), span)) => (self.aim(aim, span)? - from).dot(forward),
            None => (look - from).dot(forward),
        };
        self.out.marks.focus = Some(focus.as_ref().map_or(lens.span(), |(_, span)| *span));
        if !(distance > 0.0 && distance.is_finite()) {
            let span = focus.map_or(lens.span(), |(_, span)| span);
            self.report_view(made, errors::focus_behind(span));
            return None;
        }
        let diameter = match (lens.given(lens::APERTURE), lens.given(lens::FOCAL), lens.given(lens::STOP)) {
            (Some((aperture, _)), ..) => aperture,
            (None, Some((focal, _)), Some((stop, _))) => focal / stop,
            _ => 0.0,
        };
        Some((0.5 * diameter, distance))
    }

    fn say_placed(&mut self, camera: bool, position: DVec3, look: DVec3) {
        let show = |p: DVec3| format!("({}, {}, {})m", rounded(p.x), rounded(p.y), rounded(p.z));
        let what = if camera { "the camera has no `from`" } else { "no camera" };
        let line = format!(
            "{what}: a three-quarter view that frames everything, as `camera {{ from: {}, look: {} }}`",
            show(position),
            show(look)
        );
        self.out.notes.push(line);
    }
}

/// Whether where a camera stands, or what it looks at, is chosen for the user.
fn is_chosen(made: Fields) -> bool {
    made.given(camera::FROM).is_none() || made.given(camera::LOOK).is_none()
}

/// Four digits of a number, as the language writes it, whatever the size of the scene.
fn rounded(x: f64) -> String {
    let short = format!("{x:.3e}");
    match short.parse::<f64>() {
        Ok(x) if x == 0.0 || (1e-4..1e7).contains(&x.abs()) => format!("{x}"),
        _ => short,
    }
}

/// The unit vector to the right of a view with this upright direction, unless the two are parallel.
fn parallel_free(forward: DVec3, up: DVec3) -> Option<DVec3> {
    let right = forward.cross(up);
    if right.length() > 1e-9 { unit(right) } else { None }
}
