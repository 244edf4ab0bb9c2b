//! Rock and a water flood: channels in zones of layers, wells, and fronts that move with time.
//!
//! The flood is no simulation: a cell's water comes at an arrival time that grows with the distance
//! from the nearest injector, across faults and in poor rock, sharp in some zones and diffuse in others.

use glam::DVec2;
use rayon::prelude::*;

use super::Well;
use super::noise::{Noise, smooth_step};
use super::structure::{Fault, Structure};
use crate::model::CellIndex;

/// Layers of a zone.
const ZONE_LAYERS: usize = 5;
/// Injectors, and as many producers.
const PAIRS: usize = 3;
/// Columns looked at to place a well.
const CANDIDATES: usize = 5;
/// What a fault at its strongest adds to a distance, in parts of the longer side.
const BARRIER: f64 = 0.15;
/// Distance that water has covered at the end, in parts of the longer side.
const COVERED: f64 = 0.5;
/// Width of a saturation's rise behind its front, in the same parts.
const RISE: f64 = 0.12;
/// Distance from a well at which half of its pressure is lost.
const HALF_PRESSURE: f64 = 0.06;
/// Pressure at the oil-water contact in bar, and its growth a meter of depth.
const CONTACT_PRESSURE: f64 = 240.0;
const GRADIENT: f64 = 0.08;
/// Oil that water leaves behind, and gas beside water and oil.
const RESIDUAL_OIL: f64 = 0.2;
const MOST_GAS: f64 = 0.75;

/// A zone of layers with channels of one direction.
#[derive(Debug)]
struct Zone {
    porosity: f64,
    direction: DVec2,
    phase: f64,
    /// Part of the rise that the front itself brings: most of it where the front is sharp.
    jump: f64,
}

/// What an active cell keeps.
#[derive(Debug, Clone, Copy)]
struct Rock {
    depth: f32,
    porosity: f32,
    arrival: f32,
    jump: f32,
    /// Change of pressure at the end of the flood.
    drawdown: f32,
}

/// What the wells do to a column.
#[derive(Debug, Clone, Copy)]
struct Reach {
    /// Distance from the nearest injector, around or across the faults.
    distance: f64,
    drawdown: f64,
}

/// Properties of a faulted field.
#[derive(Debug)]
pub struct Flood {
    rocks: Vec<Rock>,
    pub(super) wells: Vec<Well>,
    gas_oil: f64,
    oil_water: f64,
    relief: f64,
}

impl Flood {
    pub(super) fn new(
        structure: &Structure,
        zcorn: &[f32],
        actnum: &[i32],
        random: &mut fastrand::Rng,
    ) -> Self {
        let columns = structure.dims.columns();
        let cells: Vec<usize> = (0..actnum.len()).filter(|&c| actnum[c] != 0).collect();
        let zones = zones(structure.dims.nk, random);
        let noise = Noise::new(random);
        let wells = Wells::place(structure, &cells, random);
        let reach = (0..columns).into_par_iter();
        let reach: Vec<Reach> = reach.map(|c| wells.reach(structure, c)).collect();
        let rock = |&cell: &usize| {
            let (column, k) = (cell % columns, cell / columns);
            let p = structure.center(column);
            let zone = &zones[k / ZONE_LAYERS];
            let porosity = zone.porosity_at(p, k, noise);
            let resistance = 1.5 - 3.0 * porosity;
            Rock {
                depth: center_depth(structure, zcorn, cell),
                porosity: porosity as f32,
                arrival: (reach[column].distance * resistance) as f32,
                jump: zone.jump as f32,
                drawdown: reach[column].drawdown as f32,
            }
        };
        let rocks: Vec<Rock> = cells.par_iter().map(rock).collect();
        let depths = rocks.iter().map(|r| f64::from(r.depth));
        let (top, bottom) = depths.fold((f64::MAX, f64::MIN), |(a, b), z| (a.min(z), b.max(z)));
        let relief = (bottom - top).max(1.0);
        let oil_water = top + 0.7 * relief;
        let is_oil = |depth: f32| f64::from(depth) < oil_water;
        let in_column = |column: usize| {
            let cells = cells.iter().zip(&rocks);
            let those = cells.filter(move |(cell, _)| *cell % columns == column);
            those.map(|(cell, rock)| (*cell, rock.depth))
        };
        let ijk = |cell: usize| structure.dims.ijk(CellIndex(cell as u32));
        let well = |letter: char, n: usize, column: usize| {
            let is_injector = letter == 'I';
            let oil = in_column(column).filter(|(_, depth)| is_oil(*depth));
            let oil: Vec<usize> = oil.map(|(cell, _)| cell).collect();
            // Producers avoid the water, where they can.
            let open: Vec<usize> = match is_injector || oil.is_empty() {
                true => in_column(column).map(|(cell, _)| cell).collect(),
                false => oil,
            };
            Well {
                name: format!("{letter}{}", n + 1),
                is_injector,
                cells: open.into_iter().map(ijk).collect(),
            }
        };
        let of = |letter: char, columns: &[usize]| -> Vec<Well> {
            let columns = columns.iter().enumerate();
            columns
                .map(|(n, column)| well(letter, n, *column))
                .collect()
        };
        let placed = [of('I', &wells.injectors), of('P', &wells.producers)].concat();
        Self {
            wells: placed,
            rocks,
            gas_oil: top + 0.1 * relief,
            oil_water,
            relief,
        }
    }

    pub(super) fn values(&self, name: &str, time: f64) -> Option<Vec<f32>> {
        let of: &(dyn Fn(&Rock) -> f64 + Sync) = match name {
            "PORO" => &Rock::poro,
            "NTG" => &Rock::net_to_gross,
            "PERMX" => &Rock::permeability,
            "PERMY" => &|r| 0.8 * r.permeability(),
            "PERMZ" => &|r| 0.1 * r.permeability() * r.net_to_gross(),
            "PRESSURE" => &|r| self.pressure(r, time),
            "SWAT" => &|r| self.water(r, time),
            "SGAS" => &|r| self.gas(r, time),
            _ => return None,
        };
        Some(self.rocks.par_iter().map(|r| of(r) as f32).collect())
    }

    /// Hydrostatic pressure, and what injection and production have done to it so far.
    fn pressure(&self, rock: &Rock, time: f64) -> f64 {
        let below_contact = f64::from(rock.depth) - self.oil_water;
        let ramp = 1.0 - (1.0 - time) * (1.0 - time);
        CONTACT_PRESSURE + GRADIENT * below_contact + ramp * f64::from(rock.drawdown)
    }

    /// Water: the aquifer with its transition zone, and what injection has added.
    fn water(&self, rock: &Rock, time: f64) -> f64 {
        let connate = rock.connate_water();
        let above_contact = (self.oil_water - f64::from(rock.depth)).max(0.0);
        let height = above_contact / (0.04 * self.relief);
        let aquifer = connate + (1.0 - connate) / (1.0 + height * height);
        let behind_front = COVERED * time - f64::from(rock.arrival);
        if behind_front <= 0.0 {
            return aquifer;
        }
        let jump = f64::from(rock.jump);
        let rise = jump + (1.0 - jump) * behind_front / (behind_front + RISE);
        aquifer.max(connate + (1.0 - RESIDUAL_OIL - connate) * rise)
    }

    /// Gas: a cap that grows downward, without the place that water takes.
    fn gas(&self, rock: &Rock, time: f64) -> f64 {
        let contact = self.gas_oil + 0.08 * self.relief * time;
        let above = (contact - f64::from(rock.depth)) / (0.02 * self.relief);
        let cap = MOST_GAS * smooth_step(above);
        cap.min(1.0 - self.water(rock, time))
    }
}

impl Rock {
    fn poro(&self) -> f64 {
        f64::from(self.porosity)
    }

    fn net_to_gross(&self) -> f64 {
        (0.2 + 3.2 * self.poro()).min(1.0)
    }

    /// Millidarcy: ten times as much for each 7 % of porosity.
    fn permeability(&self) -> f64 {
        10f64.powf((self.poro() - 0.06) / 0.07)
    }

    fn connate_water(&self) -> f64 {
        0.32 - 0.6 * self.poro()
    }
}

impl Zone {
    fn porosity_at(&self, p: DVec2, k: usize, noise: Noise) -> f64 {
        // How far from the middle of the zone, 0 to 1: channels are lenses.
        let place = (k % ZONE_LAYERS) as f64 / (ZONE_LAYERS - 1) as f64;
        let from_middle = (2.0 * place - 1.0).abs();
        let (along, across) = (p.dot(self.direction), p.dot(self.direction.perp()));
        let meander = 0.16 * noise.at(DVec2::new(5.0 * along, 100.0 * self.phase));
        let spacing = 0.4;
        let turns = (across + meander) / spacing + self.phase;
        let from_axis = spacing * (turns - turns.floor() - 0.5).abs();
        let half_width = 0.05 * (1.0 - 0.5 * from_middle);
        let channel = smooth_step(2.0 * (1.0 - from_axis / half_width));
        let texture = noise.at3((14.0 * p).extend(0.7 * k as f64));
        (self.porosity + 0.14 * channel + 0.03 * texture).clamp(0.02, 0.36)
    }
}

fn zones(nk: usize, random: &mut fastrand::Rng) -> Vec<Zone> {
    let zone = |n: usize| Zone {
        porosity: 0.07 + 0.07 * random.f64(),
        direction: DVec2::from_angle(random.f64() * std::f64::consts::PI),
        phase: random.f64(),
        jump: if n.is_multiple_of(2) { 0.6 } else { 0.0 },
    };
    (0..nk.div_ceil(ZONE_LAYERS)).map(zone).collect()
}

/// Depth of a cell: the mean of its corners.
fn center_depth(structure: &Structure, zcorn: &[f32], cell: usize) -> f32 {
    let dims = structure.dims;
    let (column, k) = (cell % dims.columns(), cell / dims.columns());
    let (i, j) = (column % dims.ni, column / dims.ni);
    let row =
        |dj: usize, dk: usize| 2 * i + 2 * dims.ni * (2 * j + dj + 2 * dims.nj * (2 * k + dk));
    let rows = [row(0, 0), row(1, 0), row(0, 1), row(1, 1)];
    let sum = |at: usize| f64::from(zcorn[at]) + f64::from(zcorn[at + 1]);
    (rows.map(sum).iter().sum::<f64>() / 8.0) as f32
}

/// Columns of the wells.
struct Wells {
    injectors: Vec<usize>,
    producers: Vec<usize>,
}

impl Wells {
    /// Injectors low on the flank, producers high on the structure, each the best of some columns
    /// taken by chance.
    fn place(structure: &Structure, cells: &[usize], random: &mut fastrand::Rng) -> Self {
        let columns = structure.dims.columns();
        let mut best = |sign: f64| {
            let candidates = (0..CANDIDATES).filter_map(|_| random.choice(cells));
            let depth = |c: usize| sign * structure.top(structure.center(c));
            let scored = candidates.map(|cell| cell % columns);
            scored.max_by(|a, b| depth(*a).total_cmp(&depth(*b)))
        };
        Self {
            injectors: (0..PAIRS).filter_map(|_| best(1.0)).collect(),
            producers: (0..PAIRS).filter_map(|_| best(-1.0)).collect(),
        }
    }

    fn reach(&self, structure: &Structure, column: usize) -> Reach {
        let distance = |well: &usize| distance(structure, *well, column);
        let pressure = |well: &usize| HALF_PRESSURE / (HALF_PRESSURE + distance(well));
        let injected: f64 = self.injectors.iter().map(pressure).sum();
        let produced: f64 = self.producers.iter().map(pressure).sum();
        let nearest = self.injectors.iter().map(distance);
        Reach {
            distance: nearest.fold(f64::MAX, f64::min),
            drawdown: 60.0 * injected - 90.0 * produced,
        }
    }
}

/// Distance in plan between two columns, longer where faults lie between them.
fn distance(structure: &Structure, from: usize, to: usize) -> f64 {
    let (a, b) = (structure.center(from), structure.center(to));
    let barrier = |fault: &Fault| {
        let ((side_a, _), (side_b, place)) = (fault.locate(a), fault.locate(b));
        let between = side_a.signum() != side_b.signum();
        f64::from(u8::from(between)) * BARRIER * Fault::strength(place)
    };
    a.distance(b) + structure.faults.iter().map(barrier).sum::<f64>()
}
