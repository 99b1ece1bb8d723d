//! Rays on their way through the hierarchy, two at a time: while one waits for memory, the other goes on.

use super::{ALONE, LEAF, Leaf, Line, Tree, WIDE, build};
use crate::render::lanes::{Float, Lanes, MOST, Mask, One, Word, apart};
use crate::render::shape::{Hits, Rays};
use crate::render::surfaces::Surfaces;
use crate::render::vector::V;

/// Nodes that wait: seven at each level, and room to write eight.
const STACK: usize = 7 * build::DEEPEST + 2 * WIDE;
/// Rays that are on their way.
const STREAMS: usize = 2;
/// A box that begins no farther behind what was met may hold what is as near but for rounding.
const SLACK: f32 = 1.0 + 8.0 * f32::EPSILON;

/// Rays of all lanes, and what they have met.
pub(super) struct Walks {
    o: [[f32; MOST]; 3],
    d: [[f32; MOST]; 3],
    start: [u32; MOST],
    detail: [u32; MOST],
    except: [u32; MOST],
    t: [f32; MOST],
    met: [u32; MOST],
    met_detail: [u32; MOST],
}

/// A ray on its way.
#[derive(Clone, Copy)]
struct Walk {
    lane: usize,
    line: Line,
    hit: Hits<One>,
    /// Boxes that begin farther away do not matter.
    limit: f32,
    /// How many nodes wait.
    waiting: usize,
}

/// Nodes that wait, and where a ray enters them.
struct Stack {
    enters: [f32; STACK],
    nodes: [u32; STACK],
}

impl Walks {
    /// Those of rays, to look for what is nearer than hits.
    #[inline(always)]
    pub fn new<L: Lanes>(rays: &Rays<L>, hits: Hits<L>, except: L::U) -> Walks {
        let mut walks = Walks {
            o: [[0.0; MOST]; 3],
            d: [[0.0; MOST]; 3],
            start: [0; MOST],
            detail: [0; MOST],
            except: [0; MOST],
            t: [0.0; MOST],
            met: [0; MOST],
            met_detail: [0; MOST],
        };
        rays.o.x.store(&mut walks.o[0]);
        rays.o.y.store(&mut walks.o[1]);
        rays.o.z.store(&mut walks.o[2]);
        rays.d.x.store(&mut walks.d[0]);
        rays.d.y.store(&mut walks.d[1]);
        rays.d.z.store(&mut walks.d[2]);
        rays.start.store(&mut walks.start);
        rays.detail.store(&mut walks.detail);
        except.store(&mut walks.except);
        hits.t.store(&mut walks.t);
        hits.place.store(&mut walks.met);
        hits.detail.store(&mut walks.met_detail);
        walks
    }

    /// What they have met.
    #[inline(always)]
    pub fn hits<L: Lanes>(&self, l: L) -> Hits<L> {
        Hits { t: l.load(&self.t), place: l.load_words(&self.met), detail: l.load_words(&self.met_detail) }
    }

    /// Goes all the ways of the rays of a mask; or of each just until it has met anything. The lanes that have met
    /// something nearer.
    #[inline(always)]
    pub fn run<L: Lanes, const ANY: bool>(
        &mut self,
        l: L,
        tree: &Tree,
        surfaces: &Surfaces,
        wanted: L::M,
    ) -> u32 {
        let wanted = wanted.bits();
        apart(
            l,
            #[inline(always)]
            || self.run_here::<L, ANY>(l, tree, surfaces, wanted),
        )
    }

    #[inline(always)]
    fn run_here<L: Lanes, const ANY: bool>(
        &mut self,
        l: L,
        tree: &Tree,
        surfaces: &Surfaces,
        wanted: u32,
    ) -> u32 {
        let mut left = wanted;
        let mut found = 0;
        let mut walks = [Walk::new(); STREAMS];
        let mut stacks = [const { Stack { enters: [0.0; STACK], nodes: [0; STACK] } }; STREAMS];
        let mut going = 0;
        for (walk, stack) in walks.iter_mut().zip(&mut stacks) {
            if left != 0 {
                self.set_out(walk, stack, &mut left);
                going += 1;
            }
        }
        while going > 0 {
            for (walk, stack) in walks.iter_mut().zip(&mut stacks) {
                if walk.waiting == 0 {
                    continue;
                }
                walk.step::<L::Group, ANY>(l.group(), stack, tree, surfaces, self);
                if walk.waiting > 0 {
                    continue;
                }
                found |= self.arrive(walk);
                if left != 0 {
                    self.set_out(walk, stack, &mut left);
                } else {
                    going -= 1;
                }
            }
        }
        found
    }

    /// Puts the first of the rays that are left on its way.
    #[inline(always)]
    fn set_out(&self, walk: &mut Walk, stack: &mut Stack, left: &mut u32) {
        let lane = left.trailing_zeros() as usize % MOST;
        *left &= *left - 1;
        let o = [self.o[0][lane], self.o[1][lane], self.o[2][lane]];
        let d = [self.d[0][lane], self.d[1][lane], self.d[2][lane]];
        walk.lane = lane;
        walk.line = Line::new(o, d, self.start[lane]);
        // What is at an infinite distance is not met.
        let t = self.t[lane].min(f32::MAX);
        walk.hit = Hits { t, place: One.u(self.met[lane]), detail: One.u(self.met_detail[lane]) };
        walk.limit = t * SLACK;
        (stack.enters[0], stack.nodes[0], walk.waiting) = (0.0, 0, 1);
    }

    /// Writes down what a ray has met; its lane's bit if that is something new.
    #[inline(always)]
    fn arrive(&mut self, walk: &Walk) -> u32 {
        let (lane, place) = (walk.lane % MOST, walk.hit.place.get(0));
        let new = u32::from(place != self.met[lane] || walk.hit.t < self.t[lane].min(f32::MAX));
        self.t[lane] = walk.hit.t;
        self.met[lane] = place;
        self.met_detail[lane] = walk.hit.detail.get(0);
        new << lane
    }

    /// The ray of a lane.
    fn ray(&self, lane: usize) -> Rays<One> {
        let [o, d] = [&self.o, &self.d].map(|v| V::splat(One, [v[0][lane], v[1][lane], v[2][lane]]));
        Rays { o, d, start: One.u(self.start[lane]), detail: One.u(self.detail[lane]) }
    }
}

impl Walk {
    #[inline(always)]
    fn new() -> Walk {
        let line = Line { o: [0.0; 3], d: [0.0; 3], inverse: [0.0; 3], start: 0, down: 0 };
        Walk {
            lane: 0,
            line,
            hit: Hits { t: 0.0, place: One.u(0), detail: One.u(0) },
            limit: 0.0,
            waiting: 0,
        }
    }

    /// Looks into the nearest of the nodes that wait.
    #[inline(always)]
    fn step<G: Lanes, const ANY: bool>(
        &mut self,
        g: G,
        stack: &mut Stack,
        tree: &Tree,
        surfaces: &Surfaces,
        walks: &Walks,
    ) {
        self.waiting -= 1;
        let at = stack.nodes[self.waiting];
        if stack.enters[self.waiting] > self.limit {
            return;
        }
        if at & (LEAF | ALONE) == 0 {
            let room = self.waiting..self.waiting + WIDE;
            let enters = (&mut stack.enters[room.clone()]).try_into().expect("room for eight");
            let nodes = (&mut stack.nodes[room]).try_into().expect("room for eight");
            self.waiting += tree.nodes[at as usize].open(g, &self.line, self.limit, enters, nodes);
            return;
        }
        let met = if at & LEAF != 0 {
            self.meet(g, &tree.leaves[(at & !LEAF) as usize], walks.except[self.lane % MOST])
        } else {
            self.meet_other(at & !ALONE, surfaces, walks)
        };
        if met {
            self.limit = self.hit.t.min(f32::MAX) * SLACK;
            if ANY {
                self.waiting = 0;
            }
        }
    }

    /// Whether the ray meets a ball of a leaf before all else.
    #[inline(always)]
    fn meet<G: Lanes>(&mut self, g: G, leaf: &Leaf, except: u32) -> bool {
        let mut any = false;
        let mut from = 0;
        while from < WIDE {
            let t = leaf.meet(g, &self.line, from);
            let ahead = g.f(0.0).lt(t) & t.le(g.f(self.hit.t));
            for lane in ahead.lanes() {
                let place = leaf.places[(from + lane) % WIDE];
                any |= self.take(Hits { t: t.get(lane), place: One.u(place), detail: One.u(0) }, except);
            }
            from += G::N;
        }
        any
    }

    /// Whether the ray meets a surface that is no ball before all else.
    #[inline(never)]
    fn meet_other(&mut self, slot: u32, surfaces: &Surfaces, walks: &Walks) -> bool {
        self.take(surfaces.meet_other(slot, &walks.ray(self.lane)), walks.except[self.lane])
    }

    #[inline(always)]
    fn take(&mut self, hit: Hits<One>, except: u32) -> bool {
        let (t, place) = (self.hit.t, self.hit.place.get(0));
        self.hit.take(hit, except);
        self.hit.t < t || self.hit.place.get(0) != place
    }
}
