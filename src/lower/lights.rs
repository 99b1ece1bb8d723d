//! Lamps and suns.

use super::*;

impl Lowering<'_> {
    /// A lamp: a point, or a glowing sphere.
    pub(super) fn lamp(&mut self, index: usize, thing: &Thing) {
        let made = thing.made;
        let power = self.things.read(made, light::COLOR) * self.things.read(made, light::POWER);
        let radius = self.things.read(made, light::RADIUS);
        let at = self.things.read(made, light::AT);
        let position = thing.world_from_object.transform_point3(at);
        if !position.is_finite() {
            return self.report(self.used_at(thing, errors::not_finite_place(made.span())));
        }
        self.extents[index] = Extent::Lamp(Bounds { min: position, max: position });
        if made.given(light::AIM).is_some() {
            // What it is aimed at may be found only later.
            return;
        }
        if radius == 0.0 {
            let intensity = power / (4.0 * PI);
            return self.add_light(thing, Light::Point { position, intensity });
        }
        let placement = thing.world_from_object * crate::math::DAffine3::from_translation(at);
        match shape::ball(placement, radius, made.span()) {
            Ok(shape) => {
                if let Some(bounds) = shape.bounds() {
                    self.extents[index] = Extent::Lamp(bounds);
                }
                let radiance = power / (PI * shape.area());
                if !radiance.is_finite() {
                    return self.report(self.used_at(thing, errors::glows_beyond(made.span())));
                }
                let material = self.materials.add(Material::Emitter { radiance, pattern: None });
                self.out.marks.materials.note(self.primitives.len(), None);
                self.add_surface(shape, material, None, thing.origin);
            }
            Err(diagnostic) => self.report(self.used_at(thing, *diagnostic)),
        }
    }

    pub(super) fn sun(&mut self, thing: &Thing) {
        let from = self.things.read(thing.made, sun::FROM);
        let Some(direction) = shape::unit(thing.world_from_object.matrix3 * from) else {
            let span = thing.made.given(sun::FROM).map_or(thing.made.span(), |(_, span)| span);
            return self.report(self.used_at(thing, errors::no_direction("from", span)));
        };
        let color = self.things.read(thing.made, sun::COLOR);
        let irradiance = color * self.things.read(thing.made, sun::IRRADIANCE);
        let radius = 0.5 * self.things.read(thing.made, sun::ANGLE);
        self.add_light(thing, Light::Sun { direction, irradiance, radius });
    }

    pub(super) fn add_light(&mut self, thing: &Thing, light: Light) {
        let finite = match light {
            Light::Point { intensity, .. } | Light::Spot { intensity, .. } => intensity.is_finite(),
            Light::Sun { irradiance, .. } => irradiance.is_finite(),
            Light::Sky { radiance, .. } => radiance.is_finite(),
        };
        match finite {
            true => {
                self.lights.push(light);
                self.out.marks.lights.push(Some(thing.origin));
            }
            false => self.report(self.used_at(thing, errors::glows_beyond(thing.made.span()))),
        }
    }

    /// A lamp that shines into a cone, in the place that was found for it.
    pub(super) fn spot(&mut self, index: usize, thing: &Thing, aim: Aim, span: Span) {
        let Extent::Lamp(Bounds { min: position, .. }) = self.extents[index] else { return };
        let target = match aim {
            Aim::Point(point) => Some(thing.world_from_object.transform_point3(point)),
            Aim::Thing(_) => self.aim(aim, span),
        };
        let Some(target) = target else { return };
        let Some(direction) = shape::unit(target - position) else {
            return self.report(self.used_at(thing, errors::aimed_at_itself(span)));
        };
        let made = thing.made;
        let Some((cone, _)) = made.given(light::CONE) else { return };
        let outer = 0.5 * cone;
        let inner = (1.0 - self.things.read(made, light::SOFT)) * outer;
        let power = self.things.read(made, light::COLOR) * self.things.read(made, light::POWER);
        // Over the cosine the smooth step has the mean ½, so the flux is 2π(1 − (cos inner + cos outer) / 2) times
        // the intensity. The half angles keep it exact for narrow cones.
        let height = |angle: f64| {
            let sine = sin(0.5 * angle);
            2.0 * sine * sine
        };
        let intensity = power / (PI * (height(inner) + height(outer)));
        self.add_light(thing, Light::Spot { position, direction, intensity, inner, outer });
    }
}
