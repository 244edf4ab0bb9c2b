//! Unit systems, length units, the units of well-known properties, and how numbers of one system become those of
//! another.

/// The unit system of a simulation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum UnitSystem {
    /// Metres, bar, sm3.
    Metric,
    /// Feet, psi, barrels.
    Field,
    /// Centimetres, atm, scc.
    Lab,
    /// Metres, atm, sm3.
    PvtM,
}

/// The unit of lengths.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LengthUnit {
    /// `METRES`.
    Metre,
    /// `FEET`.
    Foot,
    /// `CM`.
    Centimetre,
}

impl LengthUnit {
    /// From the word of GRIDUNIT or MAPUNITS, whatever its letter case; `None` for an unknown one.
    pub fn from_name(name: &str) -> Option<Self> {
        Some(match name.trim().to_ascii_uppercase().as_str() {
            "METRES" | "METERS" | "METRE" | "METER" | "M" => Self::Metre,
            "FEET" | "FOOT" | "FT" => Self::Foot,
            "CM" | "CENTIMETRES" | "CENTIMETERS" => Self::Centimetre,
            _ => return None,
        })
    }

    /// The word of GRIDUNIT and MAPUNITS.
    pub fn name(self) -> &'static str {
        ["METRES", "FEET", "CM"][self as usize]
    }

    /// Its length in meters.
    pub fn meters(self) -> f64 {
        [1.0, 0.3048, 0.01][self as usize]
    }

    /// The unit of volumes made of such lengths.
    pub fn volume(self) -> &'static str {
        ["M3", "FT3", "CM3"][self as usize]
    }

    /// The short word that is written behind numbers.
    pub fn short(self) -> &'static str {
        ["M", "FT", "CM"][self as usize]
    }
}

impl UnitSystem {
    /// From item 3 of INTEHEAD.
    pub fn from_code(code: i32) -> Option<Self> {
        Some(match code {
            1 => Self::Metric,
            2 => Self::Field,
            3 => Self::Lab,
            4 => Self::PvtM,
            _ => return None,
        })
    }

    /// What stands in item 3 of INTEHEAD.
    pub fn code(self) -> i32 {
        self as i32 + 1
    }

    /// Unit of a property; empty for one without dimension or not in the table.
    pub fn unit_of(self, property: &str) -> &'static str {
        let length = self.length().short();
        let row: [&'static str; 4] = match property {
            "PRESSURE" | "PBUB" | "PDEW" | "PPCW" | "PWAT" | "PGAS" | "PCOW" | "PCOG" | "PCW"
            | "PCG" => ["BARSA", "PSIA", "ATMA", "ATMA"],
            "PERMX" | "PERMY" | "PERMZ" => ["MD"; 4],
            "DX" | "DY" | "DZ" | "DEPTH" | "TOPS" => [length; 4],
            "PORV" | "RPORV" | "MINPVV" => ["RM3", "RB", "RCC", "RM3"],
            "RS" | "RSSAT" => ["SM3/SM3", "MSCF/STB", "SCC/SCC", "SM3/SM3"],
            "RV" | "RVSAT" => ["SM3/SM3", "STB/MSCF", "SCC/SCC", "SM3/SM3"],
            "FIPOIL" | "FIPWAT" => ["SM3", "STB", "SCC", "SM3"],
            "FIPGAS" => ["SM3", "MSCF", "SCC", "SM3"],
            "OIL_DEN" | "WAT_DEN" | "GAS_DEN" => ["KG/M3", "LB/FT3", "GM/CC", "KG/M3"],
            "OIL_VISC" | "WAT_VISC" | "GAS_VISC" => ["CP"; 4],
            "TRANX" | "TRANY" | "TRANZ" => [
                "CP.RM3/DAY/BARS",
                "CP.RB/DAY/PSI",
                "CP.RCC/HR/ATM",
                "CP.RM3/DAY/ATM",
            ],
            "TEMP" => ["C", "F", "C", "C"],
            _ => [""; 4],
        };
        row[self as usize]
    }

    /// Unit of lengths and depths.
    pub fn length(self) -> LengthUnit {
        [
            LengthUnit::Metre,
            LengthUnit::Foot,
            LengthUnit::Centimetre,
            LengthUnit::Metre,
        ][self as usize]
    }

    /// Cubic meters of the unit of pore volumes: RM3, RB or RCC.
    pub fn pore_volume_in_cubic_meters(self) -> f64 {
        [1.0, BARREL, 1e-6, 1.0][self as usize]
    }

    /// How numbers in a unit become those of this system. `quantity` is the keyword of the numbers, such as `RS`,
    /// `FIPGAS` or `WGPR`: the text SM3 stands for barrels of oil and for cubic feet of gas alike.
    ///
    /// `None` where the unit is not in the table, or the keyword does not tell which of its meanings it has.
    pub fn conversion(self, unit: &str, quantity: &str) -> Option<Conversion> {
        let to_row = |row: &Quantity| {
            let from = row.units.iter().find(|known| known.is_called(unit))?;
            let to = row.units[self as usize];
            let is_same = from.name == to.name;
            Some(Conversion {
                unit: to.name,
                factor: if is_same {
                    1.0
                } else {
                    from.factor / to.factor
                },
                offset: (from.offset - to.offset) / to.factor,
            })
        };
        let mut all = QUANTITIES.iter().filter_map(to_row);
        let first = all.next()?;
        if all.all(|other| other == first) {
            return Some(first);
        }
        let meant = meaning(quantity)?;
        let mut of_meaning = QUANTITIES.iter().filter(|row| row.meaning == Some(meant));
        of_meaning.find_map(to_row)
    }
}

/// How a number in one unit becomes one in another: `value * factor + offset`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Conversion {
    /// The other unit.
    pub unit: &'static str,
    /// What numbers are multiplied by.
    pub factor: f64,
    /// What is added to that; 0 of all but temperatures.
    pub offset: f64,
}

impl Conversion {
    /// The number in the other unit.
    pub fn of(self, value: f64) -> f64 {
        value * self.factor + self.offset
    }
}

/// Cubic meters of a barrel, and of a thousand cubic feet.
const BARREL: f64 = 0.158_987_294_928;
const MSCF: f64 = 28.316_846_592;
const FOOT: f64 = 0.3048;
/// Pascals of bar, psi and atmosphere.
const BAR: f64 = 1e5;
const PSI: f64 = 0.453_592_37 * 9.806_65 / (0.0254 * 0.0254);
const ATM: f64 = 101_325.0;
const POUND: f64 = 0.453_592_37;
/// Joules of a BTU (international table).
const BTU: f64 = 1_055.055_852_62;
/// Hours of a day.
const DAY: f64 = 24.0;

/// A unit: how many of the quantity's base unit it is, which is `value * factor + offset`.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Unit {
    name: &'static str,
    factor: f64,
    offset: f64,
}

impl Unit {
    /// True where a file may mean it by a text.
    fn is_called(&self, text: &str) -> bool {
        let also: &[&str] = match self.name {
            "BARSA" => &["BAR", "BARA"],
            "CP.RM3/DAY/BARS" => &["CPR3/DAY/BARS", "CP.RM3/D/B"],
            "DAYS" => &["DAY"],
            "HOURS" => &["HR", "HRS"],
            "M" => &["METRES"],
            "FT" => &["FEET"],
            "GM/CC" => &["G/CC", "GM/CM3"],
            _ => &[],
        };
        text == self.name || also.contains(&text)
    }
}

/// What of several meanings of a text a keyword tells.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Meaning {
    /// A volume or rate of oil or water.
    Liquid,
    /// A volume or rate of gas.
    Gas,
    /// Gas per liquid, such as RS.
    GasPerLiquid,
    /// Liquid per gas, such as RV.
    LiquidPerGas,
    /// A part, such as a water cut.
    Part,
}

/// A quantity in the four systems.
struct Quantity {
    units: [Unit; 4],
    meaning: Option<Meaning>,
}

const fn row(names: [&'static str; 4], factors: [f64; 4], meaning: Option<Meaning>) -> Quantity {
    const fn unit(name: &'static str, factor: f64) -> Unit {
        Unit {
            name,
            factor,
            offset: 0.0,
        }
    }
    Quantity {
        units: [
            unit(names[0], factors[0]),
            unit(names[1], factors[1]),
            unit(names[2], factors[2]),
            unit(names[3], factors[3]),
        ],
        meaning,
    }
}

/// The same in all systems.
const fn alike(name: &'static str) -> Quantity {
    row([name; 4], [1.0; 4], None)
}

const CELSIUS: Unit = Unit {
    name: "C",
    factor: 1.0,
    offset: 0.0,
};

/// Units by quantity, in the order of the systems. Base units are SI, Celsius, and hours; compound ones are made of
/// these.
#[rustfmt::skip]
const QUANTITIES: &[Quantity] = {
    use Meaning::{Gas, GasPerLiquid, Liquid, LiquidPerGas, Part};
    &[
        row(["BARSA", "PSIA", "ATMA", "ATMA"], [BAR, PSI, ATM, ATM], None),
        row(["BARS", "PSI", "ATM", "ATM"], [BAR, PSI, ATM, ATM], None),
        row(["1/BARS", "1/PSI", "1/ATM", "1/ATM"], [1.0 / BAR, 1.0 / PSI, 1.0 / ATM, 1.0 / ATM], None),
        row(["M", "FT", "CM", "M"], [1.0, FOOT, 0.01, 1.0], None),
        row(["M2", "FT2", "CM2", "M2"], [1.0, FOOT * FOOT, 1e-4, 1.0], None),
        row(["M3", "FT3", "CM3", "M3"], [1.0, FOOT * FOOT * FOOT, 1e-6, 1.0], None),
        row(["RM3", "RB", "RCC", "RM3"], [1.0, BARREL, 1e-6, 1.0], None),
        row(["RM3/DAY", "RB/DAY", "RCC/HR", "RM3/DAY"], [1.0 / DAY, BARREL / DAY, 1e-6, 1.0 / DAY], None),
        row(["SM3", "STB", "SCC", "SM3"], [1.0, BARREL, 1e-6, 1.0], Some(Liquid)),
        row(["SM3", "MSCF", "SCC", "SM3"], [1.0, MSCF, 1e-6, 1.0], Some(Gas)),
        row(["SM3/DAY", "STB/DAY", "SCC/HR", "SM3/DAY"], [1.0 / DAY, BARREL / DAY, 1e-6, 1.0 / DAY], Some(Liquid)),
        row(["SM3/DAY", "MSCF/DAY", "SCC/HR", "SM3/DAY"], [1.0 / DAY, MSCF / DAY, 1e-6, 1.0 / DAY], Some(Gas)),
        row(["SM3/SM3", "MSCF/STB", "SCC/SCC", "SM3/SM3"], [1.0, MSCF / BARREL, 1.0, 1.0], Some(GasPerLiquid)),
        row(["SM3/SM3", "STB/MSCF", "SCC/SCC", "SM3/SM3"], [1.0, BARREL / MSCF, 1.0, 1.0], Some(LiquidPerGas)),
        row(["SM3/SM3", "STB/STB", "SCC/SCC", "SM3/SM3"], [1.0; 4], Some(Part)),
        row(
            ["SM3/DAY/BARS", "STB/DAY/PSI", "SCC/HR/ATM", "SM3/DAY/ATM"],
            [1.0 / DAY / BAR, BARREL / DAY / PSI, 1e-6 / ATM, 1.0 / DAY / ATM],
            Some(Liquid),
        ),
        row(
            ["SM3/DAY/BARS", "MSCF/DAY/PSI", "SCC/HR/ATM", "SM3/DAY/ATM"],
            [1.0 / DAY / BAR, MSCF / DAY / PSI, 1e-6 / ATM, 1.0 / DAY / ATM],
            Some(Gas),
        ),
        row(["RM3/SM3", "RB/STB", "RCC/SCC", "RM3/SM3"], [1.0; 4], Some(Liquid)),
        row(["RM3/SM3", "RB/MSCF", "RCC/SCC", "RM3/SM3"], [1.0, BARREL / MSCF, 1.0, 1.0], Some(Gas)),
        row(["KG/M3", "LB/FT3", "GM/CC", "KG/M3"], [1.0, POUND / (FOOT * FOOT * FOOT), 1e3, 1.0], None),
        row(["KG/SM3", "LB/STB", "GM/SCC", "KG/SM3"], [1.0, POUND / BARREL, 1e3, 1.0], None),
        row(["KG", "LB", "GM", "KG"], [1.0, POUND, 1e-3, 1.0], None),
        row(["KG/DAY", "LB/DAY", "GM/HR", "KG/DAY"], [1.0 / DAY, POUND / DAY, 1e-3, 1.0 / DAY], None),
        row(["KJ", "BTU", "J", "KJ"], [1e3, BTU, 1.0, 1e3], None),
        row(["KJ/DAY", "BTU/DAY", "J/HR", "KJ/DAY"], [1e3 / DAY, BTU / DAY, 1.0, 1e3 / DAY], None),
        row(
            ["CP.RM3/DAY/BARS", "CP.RB/DAY/PSI", "CP.RCC/HR/ATM", "CP.RM3/DAY/ATM"],
            [1.0 / DAY / BAR, BARREL / DAY / PSI, 1e-6 / ATM, 1.0 / DAY / ATM],
            None,
        ),
        row(["MD.M", "MD.FT", "MD.CM", "MD.M"], [1.0, FOOT, 0.01, 1.0], None),
        row(["DAYS", "DAYS", "HOURS", "DAYS"], [DAY, DAY, 1.0, DAY], None),
        Quantity {
            units: [
                CELSIUS,
                Unit { name: "F", factor: 5.0 / 9.0, offset: -160.0 / 9.0 },
                CELSIUS,
                CELSIUS,
            ],
            meaning: None,
        },
        alike("MD"),
        alike("CP"),
    ]
};

/// Which meaning of a unit text the keyword of a property or of a summary vector tells; `None` where it tells none.
fn meaning(keyword: &str) -> Option<Meaning> {
    let ends = |all: &[&str]| all.iter().any(|end| keyword.ends_with(end));
    let is_local = ["LW", "LC", "LB"]
        .iter()
        .any(|start| keyword.starts_with(start));
    let subject = if is_local { &keyword[1..] } else { keyword };
    let vector = subject.strip_suffix('H').unwrap_or(subject);
    let of_vector = |all: &[&str]| vector.get(1..).is_some_and(|rest| all.contains(&rest));
    Some(match keyword {
        "RS" | "RSSAT" | "BRS" => Meaning::GasPerLiquid,
        "RV" | "RVSAT" | "BRV" => Meaning::LiquidPerGas,
        _ if of_vector(&["GOR", "GLR"]) => Meaning::GasPerLiquid,
        _ if of_vector(&["OGR", "WGR"]) => Meaning::LiquidPerGas,
        _ if of_vector(&["WCT"]) => Meaning::Part,
        "FIPOIL" | "FIPWAT" | "SFIPOIL" | "SFIPWAT" => Meaning::Liquid,
        "FIPGAS" | "SFIPGAS" => Meaning::Gas,
        _ if ends(&["PIO", "PIW"]) => Meaning::Liquid,
        _ if ends(&["PIG"]) => Meaning::Gas,
        // Of aquifers: AN.., FNQ...
        _ if subject.starts_with("AN") || subject.starts_with("FNQ") => Meaning::Liquid,
        // Of vectors the second letter is that of the phase; that of an aquifer's water is A.
        _ if subject.starts_with(['F', 'G', 'W', 'C', 'S', 'R', 'B', 'A']) => {
            match subject.as_bytes().get(1)? {
                b'O' | b'W' | b'L' | b'A' => Meaning::Liquid,
                b'G' => Meaning::Gas,
                _ => return None,
            }
        }
        _ => return None,
    })
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests")]
mod tests {
    use super::*;

    const ALL: [UnitSystem; 4] = [
        UnitSystem::Metric,
        UnitSystem::Field,
        UnitSystem::Lab,
        UnitSystem::PvtM,
    ];

    fn close(a: f64, b: f64, relative: f64) -> bool {
        (a - b).abs() <= relative * a.abs().max(b.abs())
    }

    /// A keyword that tells each meaning.
    fn keyword(meaning: Option<Meaning>) -> &'static str {
        match meaning {
            None => "",
            Some(Meaning::Liquid) => "FOPR",
            Some(Meaning::Gas) => "WGPRH",
            Some(Meaning::GasPerLiquid) => "RS",
            Some(Meaning::LiquidPerGas) => "FOGR",
            Some(Meaning::Part) => "WWCT",
        }
    }

    #[test]
    fn every_unit_goes_to_every_system_and_back() {
        for row in QUANTITIES {
            let keyword = keyword(row.meaning);
            for (n, from) in row.units.iter().enumerate() {
                for to in ALL {
                    let there = to.conversion(from.name, keyword).unwrap();
                    assert_eq!(there.unit, row.units[to as usize].name, "{}", from.name);
                    let back = ALL[n].conversion(there.unit, keyword).unwrap();
                    assert_eq!(back.unit, from.name);
                    for value in [-40.0, 0.0, 1.0, 273.4] {
                        let found = back.of(there.of(value));
                        assert!((found - value).abs() < 1e-9, "{} {found}", from.name);
                    }
                    // The same unit changes no bit.
                    assert!(there.unit != from.name || there.of(0.1) == 0.1);
                    let wrong = there.of(1.001);
                    assert!((back.of(wrong) - 1.0).abs() > 5e-4);
                }
            }
        }
    }

    #[test]
    fn units_of_properties_are_in_the_table() {
        let names = [
            "PRESSURE", "PERMX", "DEPTH", "PORV", "RS", "RV", "FIPOIL", "FIPGAS", "OIL_DEN",
            "OIL_VISC", "TRANX", "TEMP",
        ];
        for name in names {
            for (from, to) in ALL.iter().flat_map(|from| ALL.map(|to| (from, to))) {
                let found = to.conversion(from.unit_of(name), name).unwrap();
                assert_eq!(found.unit, to.unit_of(name), "{name}");
            }
        }
    }

    #[test]
    fn numbers_of_handbooks() {
        use UnitSystem::{Field, Lab, Metric, PvtM};
        for (value, unit, keyword, system, expected, name) in [
            (1.0, "BARSA", "PRESSURE", Field, 14.503_773_773, "PSIA"),
            (14.695_948_775_5, "PSIA", "WBHP", PvtM, 1.0, "ATMA"),
            (1.0, "ATMA", "PRESSURE", Metric, 1.013_25, "BARSA"),
            (1.0, "STB/DAY", "FOPR", Metric, 0.158_987_294_928, "SM3/DAY"),
            (1.0, "SM3/DAY", "WWPR", Field, 6.289_810_770_4, "STB/DAY"),
            (1.0, "MSCF/DAY", "FGPR", Metric, 28.316_846_592, "SM3/DAY"),
            (1.0, "SM3/DAY", "FGPR", Field, 0.035_314_666_721, "MSCF/DAY"),
            (24.0, "SM3/DAY", "FOPR", Lab, 1e6, "SCC/HR"),
            (1.0, "MSCF/STB", "RS", Metric, 178.107_606_679, "SM3/SM3"),
            (178.107_606_679, "SM3/SM3", "WGOR", Field, 1.0, "MSCF/STB"),
            (1.0, "LB/FT3", "OIL_DEN", Metric, 16.018_463_374, "KG/M3"),
            (1.0, "GM/CC", "OIL_DEN", Field, 62.427_960_576, "LB/FT3"),
            (100.0, "C", "TEMP", Field, 212.0, "F"),
            (-40.0, "F", "TEMP", Metric, -40.0, "C"),
            (1.0, "FT", "DEPTH", Metric, 0.3048, "M"),
            (1.0, "FT3", "CELL_VOLUME", Lab, 28_316.846_592, "CM3"),
            // Darcy's law for MD.M and MD.FT: 0.008527 and 0.001127.
            (
                0.3048 * 0.008_527_017_9,
                "CP.RM3/DAY/BARS",
                "TRANX",
                Field,
                0.001_127_116,
                "CP.RB/DAY/PSI",
            ),
            (
                1.0,
                "SM3/DAY",
                "LWGPR",
                Field,
                0.035_314_666_721,
                "MSCF/DAY",
            ),
            (1.0, "SM3", "FNQT", Field, 6.289_810_770_4, "STB"),
            (1.0, "SM3", "FUVOL", Lab, 1e6, "SCC"),
            (1.0, "DAYS", "TIME", Lab, 24.0, "HOURS"),
            (320.0, "MD", "PERMX", Field, 320.0, "MD"),
        ] {
            let found = system.conversion(unit, keyword).unwrap();
            assert_eq!(found.unit, name);
            assert!(
                close(found.of(value), expected, 2e-6),
                "{unit} {}",
                found.of(value)
            );
            assert!(!close(found.of(1.01 * value), expected, 2e-6), "{unit}");
        }
    }

    #[test]
    fn what_is_not_known_is_left_alone() {
        for (unit, keyword) in [
            ("", "SWAT"),
            ("STRANGE", "FOPR"),
            // Whether barrels or cubic feet is not said.
            ("SM3", "FUVOL"),
            ("SM3/SM3", "XYZ"),
            ("SM3/DAY", ""),
            ("SM3", "LW"),
            ("PSI A", "PRESSURE"),
        ] {
            assert_eq!(UnitSystem::Field.conversion(unit, keyword), None, "{unit}");
        }
        // The other way the text says it all.
        let found = UnitSystem::Metric.conversion("MSCF", "FUVOL").unwrap();
        assert_eq!((found.unit, found.factor), ("SM3", MSCF));
    }
}
