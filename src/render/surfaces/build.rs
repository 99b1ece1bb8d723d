//! Making the tables and the hierarchy.

use super::{Ball, Exact, Flat, Giant, Quadric, Surfaces, Table, Tree};
use crate::render::accel::Item;
use crate::render::shape::Nature;
use crate::render::space::Space;
use crate::scene::{Material, Primitive, PrimitiveId, Scene, Shape};

/// Surfaces with an end that take up to so long are tested one by one, which is then faster than a hierarchy: in the time
/// of a ball.
const DIRECT: usize = 96;

#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Kind {
    Flat,
    Giant,
    Ball,
    Quadric,
    Exact,
}

impl Kind {
    /// About how long it takes to test one surface for all lanes, in the time of a ball.
    fn cost(self) -> usize {
        match self {
            Kind::Flat | Kind::Giant | Kind::Ball => 1,
            Kind::Quadric => 6,
            // Lane by lane.
            Kind::Exact => 24,
        }
    }
}

impl Surfaces {
    /// Those of a scene.
    pub fn new(scene: &Scene, space: &Space) -> Surfaces {
        let kind = |shape: &Shape| match shape {
            Shape::Plane { .. } => Kind::Flat,
            Shape::Sphere { center, radius } => {
                if Giant::is(space.point(*center), space.length(*radius)) {
                    Kind::Giant
                } else {
                    Kind::Ball
                }
            }
            Shape::Quadric(_) => Kind::Quadric,
            Shape::Disk(_) | Shape::Box(_) | Shape::Mesh(_) => Kind::Exact,
        };
        let mut order: Vec<(Kind, PrimitiveId)> =
            (0..).zip(scene.primitives.iter()).map(|(id, p)| (kind(&p.shape), PrimitiveId(id))).collect();
        order.sort_unstable();
        let count = |last: Kind| order.partition_point(|(kind, _)| *kind <= last) as u32;
        let starts = [
            count(Kind::Flat),
            count(Kind::Giant),
            count(Kind::Ball),
            count(Kind::Quadric),
            order.len() as u32,
        ];
        let mut surfaces = Surfaces {
            flats: Vec::new(),
            giants: Vec::new(),
            balls: Vec::new(),
            quadrics: Vec::new(),
            starts,
            primitives: order.iter().map(|(_, id)| *id).collect(),
            slots: vec![0; order.len()],
            exact: Exact::new(scene, space),
            space: *space,
            direct_quadrics: Vec::new(),
            tree: None,
            any_smooth: false,
            closed: Vec::new(),
            anchors: Table::default(),
            leans: Table::default(),
        };
        let (mut anchors, mut leans) = (Vec::with_capacity(order.len()), Vec::new());
        for (slot, (kind, id)) in (0..).zip(order) {
            surfaces.slots[id.0 as usize] = slot;
            let primitive = &scene.primitives[id.0 as usize];
            surfaces.closed.push(primitive.shape.is_closed());
            let nature = Nature::of(scene.material(primitive));
            let (anchor, lean) = surfaces.push(kind, &primitive.shape, nature, space);
            anchors.push(anchor);
            leans.extend(lean);
        }
        leans.push([0.0; 4]);
        (surfaces.anchors, surfaces.leans) = (Table::new(anchors), Table::new(leans));
        surfaces.plant(scene, space);
        surfaces
    }

    /// Those of a scene whose surfaces are where they were in the scene that these were made of, with the same natures, as
    /// seen from the same place. `materials` are those of that scene. None where that is not so.
    pub fn kept(mut self, materials: &[Material], scene: &Scene, space: &Space) -> Option<Surfaces> {
        let before = self.exact.primitives();
        let same = |(before, after): (&Primitive, &Primitive)| {
            let nature = Nature::of(&materials[before.material.0 as usize]);
            before.shape == after.shape && nature == Nature::of(scene.material(after))
        };
        let fits = self.space == *space
            && before.len() == scene.primitives.len()
            && before.iter().zip(scene.primitives.iter()).all(same);
        fits.then(|| {
            self.exact.refer_to(scene);
            self
        })
    }

    /// Builds the hierarchy if there is much to test.
    fn plant(&mut self, scene: &Scene, space: &Space) {
        let mut alone = vec![true; self.quadrics.len()];
        self.tree = self.hierarchy(scene, space, |index| alone[index as usize] = false);
        if self.tree.is_some() {
            self.balls = Vec::new();
        } else {
            alone.fill(true);
        }
        self.direct_quadrics = (0..).zip(alone).filter(|(_, alone)| *alone).map(|(index, _)| index).collect();
    }

    /// The hierarchy over what has an end, if that is much. Says which quadrics are among it.
    pub fn hierarchy(&self, scene: &Scene, space: &Space, mut held: impl FnMut(u32)) -> Option<Tree> {
        let first = self.starts[1];
        let mut bounded = Vec::with_capacity((self.starts[4] - first) as usize);
        let mut cost = 0;
        for slot in first..self.starts[4] {
            let bounds = scene.primitives[self.primitive(slot).0 as usize].shape.bounds();
            let kind = self.kind(slot);
            let item = bounds.and_then(|bounds| Item::new(slot, kind != Kind::Ball, bounds, space));
            let Some(item) = item else { continue };
            bounded.push(item);
            cost += kind.cost();
            if kind == Kind::Quadric {
                held(slot - self.starts[2]);
            }
        }
        let balls = &self.anchors.rows()[first as usize..self.starts[2] as usize];
        (cost > DIRECT).then(|| Tree::new(bounded, balls, first))
    }

    /// Adds a surface; its rows of [`Surfaces::anchors`] and, if it has one, [`Surfaces::leans`].
    fn push(
        &mut self,
        kind: Kind,
        shape: &Shape,
        nature: Nature,
        space: &Space,
    ) -> ([f32; 4], Option<[f32; 4]>) {
        match *shape {
            Shape::Plane { point, normal } => {
                let flat = Flat::new(space.point(point), normal, nature);
                self.flats.push(flat);
                let [x, y, z] = flat.n;
                ([0.0; 4], Some([x, y, z, flat.height]))
            }
            Shape::Sphere { center, radius } if kind == Kind::Giant => {
                let giant = Giant::new(space.point(center), space.length(radius), nature);
                self.giants.push(giant);
                let [x, y, z] = giant.g;
                ([0.0, 0.0, 0.0, giant.curvature], Some([x, y, z, giant.height]))
            }
            Shape::Sphere { center, radius } => {
                let ball = Ball::new(space.point(center), space.length(radius), nature);
                self.balls.push(ball);
                let [x, y, z] = ball.center;
                ([x, y, z, ball.radius], None)
            }
            Shape::Quadric(ref quadric) => {
                self.quadrics.push(Quadric::new(quadric, space, nature));
                ([0.0; 4], None)
            }
            Shape::Mesh(ref instance) => {
                self.any_smooth |= instance.smooth;
                ([0.0; 4], None)
            }
            Shape::Disk(_) | Shape::Box(_) => ([0.0; 4], None),
        }
    }

    fn kind(&self, slot: u32) -> Kind {
        let [giants, balls, quadrics, exact, _] = self.starts;
        match slot {
            _ if slot < giants => Kind::Flat,
            _ if slot < balls => Kind::Giant,
            _ if slot < quadrics => Kind::Ball,
            _ if slot < exact => Kind::Quadric,
            _ => Kind::Exact,
        }
    }
}
