//! Unit systems, length units, and the units of well-known properties.

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
        [1.0, 0.158_987_294_928, 1e-6, 1.0][self as usize]
    }
}
