//! What the camera sees: W0601, W0602 and W0608.

use super::{Lint, errors};
use crate::math::{DVec3, acos};
use crate::scene::{Camera, Light, Primitive, Projection, Shape};

/// A circle of blur up to this share of the picture's width still counts as sharp. It is far more than a
/// photographer allows (about 1/1500), so that what is warned of is blurred to any eye.
const SHARP: f64 = 0.01;

/// Beyond the edge of the picture a reconstruction filter still sees up to two pixels.
const FILTER_RADIUS: f64 = 2.0;

pub(super) fn look(lint: &mut Lint) {
    inside(lint);
    let Some(view) = View::new(lint) else { return };
    let shapes = || lint.scene.primitives.iter().map(|primitive| &primitive.shape);
    if !lint.scene.primitives.is_empty() && !shapes().any(|shape| view.may_see(shape)) {
        if !sees_sun(lint, &view) {
            let diagnostic = errors::nothing_in_view(lint);
            lint.report(diagnostic);
        }
        return;
    }
    let camera = lint.camera;
    if camera.lens_radius > 0.0 && !shapes().any(|shape| view.may_be_sharp(shape)) {
        let nearest = shapes()
            .filter(|shape| view.may_see(shape))
            .filter_map(|shape| view.depths(shape))
            .map(|[near, far]| camera.focus.clamp(near, far))
            .min_by(|a, b| (a - camera.focus).abs().total_cmp(&(b - camera.focus).abs()));
        let diagnostic = errors::focus_misses(lint, nearest);
        lint.report(diagnostic);
    }
}

/// W0601: the camera stands in a solid that nothing gets through. Exact, by [`Shape::contains`].
fn inside(lint: &mut Lint) {
    let position = lint.camera.position;
    let around = |primitive: &&Primitive| lint.is_opaque(primitive) && primitive.shape.contains(position);
    if let Some(solid) = lint.scene.primitives.iter().find(around) {
        let diagnostic = errors::camera_inside(lint, solid.origin);
        lint.report(diagnostic);
    }
}

/// Whether the disc of a sun stands in the picture.
fn sees_sun(lint: &Lint, view: &View) -> bool {
    lint.scene.lights.iter().any(|light| match light {
        Light::Sun { direction, radius, .. } => *radius > 0.0 && view.may_see_direction(*direction, *radius),
        Light::Point { .. } | Light::Spot { .. } | Light::Sky { .. } => false,
    })
}

/// The part of space that the picture shows: four planes and what lies in front, widened by the lens and the
/// reconstruction filter.
struct View<'a> {
    camera: &'a Camera,
    /// Unit normals out of the four sides, which pass through the camera.
    sides: [DVec3; 4],
    /// By how much a point may lie outside of each side and be seen: by the rim of the lens, or by the width of a
    /// parallel view.
    slack: [f64; 4],
}

impl<'a> View<'a> {
    fn new(lint: &'a Lint) -> Option<View<'a>> {
        let camera = lint.camera;
        let [width, height] = lint.scene.trace.size.map(f64::from);
        // A ray through the rim starts one lens radius aside, and leans by radius/focus more.
        let lean = camera.lens_radius / camera.focus;
        let half_width = camera.half_extent.x * (1.0 + 2.0 * FILTER_RADIUS / width);
        let half_height = camera.half_extent.y * (1.0 + 2.0 * FILTER_RADIUS / height);
        let across = [camera.right, -camera.right, camera.up, -camera.up];
        let half = [half_width, half_width, half_height, half_height];
        let (sides, slack) = match camera.projection {
            Projection::Perspective => {
                let side = |i: usize| (across[i] - (half[i] + lean) * camera.forward).normalize();
                ([0, 1, 2, 3].map(side), [camera.lens_radius; 4])
            }
            Projection::Orthographic => (across, half),
        };
        let sound = sides.iter().all(|side| side.is_finite());
        sound.then_some(View { camera, sides, slack })
    }

    /// Whether a shape may be in the picture. No is always true of a shape with bounds, and of a plane: it lies
    /// behind the camera, or outside of one side of what the picture shows. A shape that has neither bounds nor is a
    /// plane counts as seen, and so does what is hidden behind another thing or lies past a corner of the picture.
    fn may_see(&self, shape: &Shape) -> bool {
        if let Shape::Plane { point, normal } = shape {
            // A ray meets the plane if it leads to its other side; the steepest are at the corners.
            let height = |depth: f64| self.corners(depth).map(|p| normal.dot(p - *point));
            let meets = |(start, next): (f64, f64)| start * (next - start) < 0.0;
            return height(0.0).into_iter().zip(height(1.0)).any(meets)
                || height(0.0)[0].abs() <= self.camera.lens_radius;
        }
        let reach = |direction| shape.reach(direction, self.camera.position);
        let Some(in_front) = reach(self.camera.forward) else { return true };
        let outside = |(side, slack): (&DVec3, &f64)| reach(-*side).is_some_and(|depth| depth < -slack);
        in_front > 0.0 && !self.sides.iter().zip(&self.slack).any(outside)
    }

    /// Whether some of a disc in the sky may be in the picture, by its centre and its angular radius.
    fn may_see_direction(&self, direction: DVec3, radius: f64) -> bool {
        let right_angle = 0.5 * crate::math::PI;
        let apart = |side: &DVec3| acos(side.dot(direction).clamp(-1.0, 1.0));
        // All parallel rays see the same point of the sky.
        if self.camera.projection == Projection::Orthographic {
            return acos(self.camera.forward.dot(direction).clamp(-1.0, 1.0)) <= radius;
        }
        self.sides.iter().all(|side| apart(side) + radius > right_angle)
            && (direction.dot(self.camera.forward) > 0.0 || radius > 0.5)
    }

    /// The corners of what is shown at a depth.
    fn corners(&self, depth: f64) -> [DVec3; 4] {
        let camera = self.camera;
        let half = match camera.projection {
            Projection::Perspective => depth * camera.half_extent,
            Projection::Orthographic => camera.half_extent,
        };
        let middle = camera.position + depth * camera.forward;
        [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)]
            .map(|(x, y)| middle + x * half.x * camera.right + y * half.y * camera.up)
    }

    /// The least and the greatest depth of a shape with bounds.
    fn depths(&self, shape: &Shape) -> Option<[f64; 2]> {
        let far = shape.reach(self.camera.forward, self.camera.position)?;
        let near = -shape.reach(-self.camera.forward, self.camera.position)?;
        Some([near.max(0.0), far])
    }

    /// The depths that are sharp: at depth z the circle of blur, seen from the lens, is 2r·|1/focus − 1/z| wide
    /// (similar triangles), and the picture 2·half_extent.x.
    fn sharp(&self) -> [f64; 2] {
        let camera = self.camera;
        let tolerance = SHARP * camera.half_extent.x / camera.lens_radius;
        let nearness = 1.0 / camera.focus;
        [1.0 / (nearness + tolerance), 1.0 / (nearness - tolerance).max(0.0)]
    }

    /// Whether a shape may be in the picture and sharp there: its depths and those of the sharp range meet. A plane
    /// is followed within the view; whatever else is endless counts as sharp.
    fn may_be_sharp(&self, shape: &Shape) -> bool {
        let [near, far] = self.sharp();
        if let Shape::Plane { point, normal } = shape {
            let ends = [near, far.min(f64::MAX.sqrt())];
            let heights = ends.iter().flat_map(|z| self.corners(*z).map(|p| normal.dot(p - *point)));
            let [low, high] = heights.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], height| {
                [low.min(height), high.max(height)]
            });
            return low <= 0.0 && 0.0 <= high;
        }
        let depths = self.depths(shape);
        self.may_see(shape) && depths.is_none_or(|[start, end]| start <= far && near <= end)
    }
}
