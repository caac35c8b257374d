//! A step of many worlds: the iterations over velocities side by side in vector registers, the rest one world after the other.
//!
//! A single world leaves a processor mostly waiting, since every operation of its iterations needs the one before. Worlds know
//! nothing of each other, so theirs overlap. Each has the bits of [`World::step`].

use pulp::{Arch, Simd, WithSimd};

use super::hinge_row::{HingeRow, Sums, Twist};
use super::island::Island;
use super::packed::Packed;
use super::relax::{Hinges, Twists};
use super::world::World;

/// With fewer worlds than this, each alone is faster: a world alone may leave out iterations that repeat themselves.
const FEWEST: usize = 4;

/// Lets `step_s` seconds pass in every world, which must all have the same settings.
pub(crate) fn step(worlds: &mut [&mut World], step_s: f32) {
    let mut islands = Vec::with_capacity(worlds.len());
    for (index, world) in worlds.iter_mut().enumerate() {
        if let Some(island) = world.begin_step(step_s) {
            islands.push((index, island));
        }
    }
    let iterations = worlds.first().map_or(0, |world| world.settings.velocity_iterations);
    let (mut free, mut touching): (Vec<_>, Vec<_>) =
        islands.iter_mut().map(|(_, island)| island).partition(|island| island.contacts.is_empty());
    Arch::new().dispatch(Relax { islands: &mut free, iterations });
    touching.iter_mut().for_each(|island| island.solve_velocities(iterations));
    for (index, island) in &mut islands {
        worlds[*index].move_bodies(island, step_s);
    }
    worlds.iter_mut().for_each(|world| world.end_step(step_s));
}

/// The iterations over velocities of islands without contacts.
struct Relax<'a, 'b> {
    islands: &'a mut [&'b mut Island],
    iterations: u32,
}

impl WithSimd for Relax<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Relax { islands, iterations } = self;
        if S::IS_SCALAR {
            return islands.iter_mut().for_each(|island| island.solve_velocities(iterations));
        }
        for group in islands.chunks_mut(Packed::<S, 2>::LANES) {
            if group.len() < FEWEST {
                group.iter_mut().for_each(|island| island.solve_velocities(iterations));
            } else if group.len() <= Packed::<S, 1>::LANES {
                relax::<S, 1>(simd, group, iterations);
            } else {
                relax::<S, 2>(simd, group, iterations);
            }
        }
    }
}

/// Iterates over the velocities of at most as many islands as there are lanes.
#[inline(always)]
fn relax<S: Simd, const V: usize>(simd: S, islands: &mut [&mut Island], iterations: u32) {
    let group = Group::<S, V> { simd, islands };
    let (mut hinges, mut twists) = (group.hinges(), group.twists());
    for _ in 0..iterations {
        hinges.iterate(&mut twists);
    }
    scatter(islands, &hinges, &twists);
}

/// Islands whose numbers are put side by side.
struct Group<'a, 'b, S, const V: usize> {
    simd: S,
    islands: &'a [&'b mut Island],
}

impl<S: Simd, const V: usize> Group<'_, '_, S, V> {
    #[inline(always)]
    fn number(&self, number: impl Fn(&Island) -> f32) -> Packed<S, V> {
        Packed::gather(self.simd, self.islands, |island| number(island))
    }

    #[inline(always)]
    fn numbers<const N: usize>(&self, numbers: impl Fn(&Island) -> [f32; N]) -> [Packed<S, V>; N] {
        std::array::from_fn(|i| self.number(|island| numbers(island)[i]))
    }

    #[inline(always)]
    fn hinges(&self) -> Hinges<Packed<S, V>> {
        Hinges {
            rows: [0, 1].map(|hinge| self.row(|island| &island.hinges.rows[hinge])),
            sums: [0, 1].map(|hinge| self.sums(|island| &island.hinges.sums[hinge])),
        }
    }

    #[inline(always)]
    fn row(&self, row: impl Fn(&Island) -> &HingeRow<f32>) -> HingeRow<Packed<S, V>> {
        HingeRow {
            hull_arm: self.numbers(|island| row(island).hull_arm),
            leg_arm: self.numbers(|island| row(island).leg_arm),
            inverse_masses: self.numbers(|island| row(island).inverse_masses),
            matrix: self.numbers(|island| row(island).matrix),
            inverses: self.numbers(|island| row(island).inverses),
            motor_mass: self.number(|island| row(island).motor_mass),
            motor_speed: self.number(|island| row(island).motor_speed),
            max_motor_impulse: self.number(|island| row(island).max_motor_impulse),
            limit_side: self.number(|island| row(island).limit_side),
        }
    }

    #[inline(always)]
    fn sums(&self, sums: impl Fn(&Island) -> &Sums<f32>) -> Sums<Packed<S, V>> {
        Sums {
            pin: self.numbers(|island| sums(island).pin),
            limit: self.number(|island| sums(island).limit),
            motor: self.number(|island| sums(island).motor),
        }
    }

    #[inline(always)]
    fn twists(&self) -> Twists<Packed<S, V>> {
        [0, 1, 2].map(|body| Twist {
            x: self.number(|island| island.twists[body].x),
            y: self.number(|island| island.twists[body].y),
            omega: self.number(|island| island.twists[body].omega),
        })
    }
}

/// Gives every island its lane's velocities and impulses.
#[inline(always)]
fn scatter<S: Simd, const V: usize>(
    islands: &mut [&mut Island],
    hinges: &Hinges<Packed<S, V>>,
    twists: &Twists<Packed<S, V>>,
) {
    let sums = hinges.sums.map(|sums| [sums.pin[0], sums.pin[1], sums.limit, sums.motor].map(Packed::lanes));
    let twists = twists.map(|twist| [twist.x, twist.y, twist.omega].map(Packed::lanes));
    for (lane, island) in islands.iter_mut().enumerate() {
        island.hinges.sums = sums.map(|numbers| {
            let [x, y, limit, motor] = numbers.map(|lanes| lanes[lane]);
            Sums { pin: [x, y], limit, motor }
        });
        island.twists = twists.map(|numbers| {
            let [x, y, omega] = numbers.map(|lanes| lanes[lane]);
            Twist { x, y, omega }
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::craft::{Controls, Craft, Engines, Ground, Settings, Start};

    const ITERATIONS: u32 = 180;

    /// Islands of crafts in flight, each pushed and steered in another way: limits reached, left and free.
    fn islands(count: usize) -> Vec<Island> {
        let ground = Ground::polyline(&[[-100.0, 0.0], [100.0, 0.0]]).expect("a chain");
        let island = |index: usize| {
            let push = [index as f64 * 83.0 % 2000.0 - 1000.0, index as f64 * 119.0 % 2000.0 - 1000.0];
            let start = Start { push, ..Start::at(0.0, 90.0) };
            let mut craft = Craft::place(&ground, &start, Settings::EXACT);
            for tick in 0..index * 7 % 80 {
                let engines = Engines::burning(tick % 3 == 0, index % 3 == 1, index % 3 == 2);
                craft.tick(&Controls { engines, ..Controls::IDLE });
            }
            craft.world().clone().begin_step(0.02).expect("awake")
        };
        (0..count).map(island).collect()
    }

    fn bits(island: &Island) -> Vec<u32> {
        let twists = island.twists.iter().flat_map(|twist| [twist.x, twist.y, twist.omega]);
        let sums = &island.hinges.sums;
        let sums = sums.iter().flat_map(|sums| [sums.pin[0], sums.pin[1], sums.limit, sums.motor]);
        twists.chain(sums).map(f32::to_bits).collect()
    }

    /// Islands relaxed in lanes of `S`, `V` registers wide, beside the same islands alone.
    struct Widths<'a>(&'a [Island]);

    impl WithSimd for Widths<'_> {
        type Output = ();

        #[inline(always)]
        fn with_simd<S: Simd>(self, simd: S) {
            check::<S, 1>(simd, self.0);
            check::<S, 2>(simd, self.0);
        }
    }

    #[inline(always)]
    fn check<S: Simd, const V: usize>(simd: S, islands: &[Island]) {
        for group in islands.chunks(Packed::<S, V>::LANES) {
            let mut lanes = group.to_vec();
            relax::<S, V>(simd, &mut lanes.iter_mut().collect::<Vec<_>>(), ITERATIONS);
            for (mut alone, lane) in group.iter().cloned().zip(&lanes) {
                alone.solve_velocities(ITERATIONS);
                assert_eq!(bits(lane), bits(&alone), "{} lanes", Packed::<S, V>::LANES);
            }
        }
    }

    /// 75: no multiple of any number of lanes, so that some stay empty.
    #[test]
    fn every_lane_of_every_instruction_set_has_the_bits_of_its_world_alone() {
        let islands = islands(75);
        Widths(&islands).with_simd(pulp::Scalar::new());
        #[cfg(target_arch = "x86_64")]
        {
            pulp::x86::V3::try_new().iter().for_each(|simd| Simd::vectorize(*simd, Widths(&islands)));
            pulp::x86::V4::try_new().iter().for_each(|simd| Simd::vectorize(*simd, Widths(&islands)));
        }
        #[cfg(target_arch = "aarch64")]
        pulp::aarch64::Neon::try_new().iter().for_each(|simd| Simd::vectorize(*simd, Widths(&islands)));
    }
}
