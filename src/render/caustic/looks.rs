//! What paths want to know about caustics, gathered until there is enough of it to fill all lanes.

use super::answer::Work;
use super::chain::Ways;
use super::seeds::Cell;
use crate::color::Rgb;
use crate::render::Tracer;
use crate::render::lanes::Lanes;
use crate::render::media::Inside;
use crate::render::observer::{Contribution, Observer, Way};
use crate::render::queue::{Arrived, Jobs};

/// Something that a path wants to know of a place that it has come by.
#[derive(Clone, Copy)]
pub struct Look {
    /// Where the answer is added up.
    pub ticket: u32,
    /// Scattering events between the lamp and the camera, all and rough ones.
    pub bounces: [u32; 2],
    /// How the path leaves the first surface that scatters it.
    pub first: Way,
    /// The place, and the normal on the side of the path.
    pub p: [f32; 3],
    /// See `p`.
    pub n: [f32; 3],
    /// The surface that it lies on.
    pub place: u32,
    /// See `place`.
    pub detail: u32,
    /// How often light is looked for there.
    pub effort: f32,
    /// The cell around it.
    pub cell: Cell,
    /// Sum of the weights of the cell's seeds.
    pub total: f32,
    /// The way to the lamp.
    pub ways: Ways,
    /// The lamp, by its place among the goals.
    pub goal: u32,
    /// What the path wants to know.
    pub wanted: Wanted,
}

/// What a path wants to know.
#[derive(Clone, Copy)]
pub enum Wanted {
    /// The light that comes by a chain.
    Light {
        /// The seed to aim by, by its place in the cell.
        seed: u32,
        /// A number to choose with.
        rest: f32,
        /// Numbers to draw a direction with.
        u: [f32; 2],
        /// How the light is scattered to the camera.
        scattering: Scattering,
    },
    /// The light that comes from a lamp without size by a chain that no seed of the place knows.
    Unknown {
        /// The key of random numbers.
        key: u64,
        /// How the light is scattered to the camera.
        scattering: Scattering,
    },
    /// The share that counts of light that was met by chance.
    Share {
        /// The direction in which the chain starts.
        w: [f32; 3],
        /// Its density by chance, and the probability of the way from there.
        odds: f32,
        /// The light, were there no other way to find it.
        radiance: [f32; 3],
    },
}

/// How a surface scatters light towards the camera.
#[derive(Clone, Copy, Default)]
pub struct Scattering {
    /// What a unit of radiance that leaves it adds to the pixel's.
    pub throughput: [f32; 3],
    /// Towards the camera, in the local frame.
    pub wo: [f32; 3],
    /// The normal of the surface itself, on the side of the path.
    pub rim: [f32; 3],
    /// See [`Bsdfs`](crate::render::bsdf::Bsdfs).
    pub kind: u32,
    /// See [`Bsdfs`](crate::render::bsdf::Bsdfs).
    pub color: [f32; 3],
    /// See [`Bsdfs`](crate::render::bsdf::Bsdfs).
    pub alpha: f32,
    /// See [`Bsdfs`](crate::render::bsdf::Bsdfs).
    pub coat: u32,
}

/// What paths wait to know.
#[derive(Default)]
pub struct Looks {
    list: Vec<Look>,
    /// What the place of each is inside of; there may be more, for later use.
    insides: Vec<Inside>,
    waiting: Vec<Waiting>,
    /// Those that nobody waits for.
    free: Vec<u32>,
    work: Work,
}

/// What a path waits for.
#[derive(Clone, Copy, Default)]
struct Waiting {
    looks: u32,
    sum: [f32; 3],
    arrived: Option<Arrived>,
}

impl Looks {
    /// How many there are to answer.
    pub fn len(&self) -> usize {
        self.list.len()
    }

    /// A place to add answers up.
    pub fn ticket(&mut self) -> u32 {
        self.free.pop().unwrap_or_else(|| {
            self.waiting.push(Waiting::default());
            self.waiting.len() as u32 - 1
        })
    }

    /// Notes what a path wants to know, from a place that lies in these solids.
    pub fn push(&mut self, look: Look, inside: &Inside) {
        match self.insides.get_mut(self.list.len()) {
            Some(known) => known.clone_from(inside),
            None => self.insides.push(inside.clone()),
        }
        self.waiting[look.ticket as usize].looks += 1;
        self.list.push(look);
    }

    /// Takes what a path brought that has ended, until all is known.
    pub fn arrive(&mut self, ticket: u32, arrived: Arrived, jobs: &mut dyn Jobs) {
        let waiting = &mut self.waiting[ticket as usize];
        waiting.arrived = Some(arrived);
        if waiting.looks == 0 {
            self.hand_over(ticket, jobs);
        }
    }

    /// Hands over what a path brought.
    fn hand_over(&mut self, ticket: u32, jobs: &mut dyn Jobs) {
        let Waiting { sum, arrived, .. } = std::mem::take(&mut self.waiting[ticket as usize]);
        if let Some(arrived) = arrived {
            let ([r, g, b], [x, y, z]) = (arrived.radiance, sum);
            let radiance = [r + x, g + y, b + z];
            jobs.finish(&Arrived { radiance, ..arrived });
        }
        self.free.push(ticket);
    }

    /// Answers all.
    #[inline(always)]
    pub fn answer<L: Lanes, O: Observer>(
        &mut self,
        l: L,
        tracer: &Tracer,
        jobs: &mut dyn Jobs,
        observer: &mut O,
    ) {
        self.work.answer(l, tracer, &mut self.list, &self.insides);
        for index in 0..self.list.len() {
            let Look { ticket, bounces, first, goal, .. } = self.list[index];
            let answer = self.work.answers[index];
            let waiting = &mut self.waiting[ticket as usize];
            for (sum, answer) in waiting.sum.iter_mut().zip(answer) {
                *sum += answer;
            }
            waiting.looks -= 1;
            if O::WATCHES && answer != [0.0; 3] {
                observer.contributed(&Contribution {
                    source: tracer.caustics.goals[goal as usize].source,
                    bounces: bounces[0],
                    rough_bounces: bounces[1],
                    first: Some(first),
                    radiance: Rgb::from_array(answer.map(f64::from)) * tracer.unit,
                });
            }
            if waiting.looks == 0 && waiting.arrived.is_some() {
                self.hand_over(ticket, jobs);
            }
        }
        self.list.clear();
    }
}
