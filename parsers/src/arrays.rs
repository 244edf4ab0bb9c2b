//! Keywords that give one value per cell, told from those that give tables or vectors.

/// Cell arrays of decks, INIT files and restarts.
const CELL_ARRAYS: &[&str] = &[
    // Geometry and rock.
    "ACTNUM", "DX", "DY", "DZ", "DZNET", "TOPS", "DEPTH", "PORO", "PORV", "RPORV", "NTG", "PERMX",
    "PERMY", "PERMZ", "PERMR", "PERMTHT", "PERMXY", "PERMYZ", "PERMZX", "MULTPV", "MINPVV",
    "SIGMAV", "DZMTRXV", "ROCKFRAC", "THCONR", "THCROCK", "THCOIL", "THCGAS", "THCWATER",
    "THCONSF", "HEATCR", "HEATCRT", "VSH", "FACIES", // Flow between cells.
    "MULTX", "MULTX-", "MULTY", "MULTY-", "MULTZ", "MULTZ-", "MULTR", "MULTTHT", "TRANX", "TRANY",
    "TRANZ", "TRANR", "TRANTHT", "DIFFX", "DIFFY", "DIFFZ", "DIFFMX", "DIFFMY", "DIFFMZ", "HEATTX",
    "HEATTY", "HEATTZ", // Regions.
    "SATNUM", "PVTNUM", "EQLNUM", "FLUXNUM", "MULTNUM", "OPERNUM", "IMBNUM", "ENDNUM", "ROCKNUM",
    "EOSNUM", "MISCNUM", "PINCHNUM", "ISOLNUM", "COALNUM", "KRNUMX", "KRNUMX-", "KRNUMY",
    "KRNUMY-", "KRNUMZ", "KRNUMZ-", "ENKRNUM", "LSLTWNUM", "LWSLTNUM", "RESIDNUM", "SURFNUM",
    "SURFWNUM", "TNUM", "WH2NUM", "WH3NUM", "PLMIXNUM", "HWSNUM", "HWWNUM", "CORSNUM",
    // End points of saturation functions.
    "SWL", "SWCR", "SWU", "SGL", "SGCR", "SGU", "SOWCR", "SOGCR", "SWLPC", "SGLPC", "KRW", "KRWR",
    "KRG", "KRGR", "KRO", "KRORW", "KRORG", "PCW", "PCG", "ISWL", "ISWCR", "ISWU", "ISGL", "ISGCR",
    "ISGU", "ISOWCR", "ISOGCR", "IKRW", "IKRWR", "IKRG", "IKRGR", "IKRO", "IKRORW", "IKRORG",
    "IPCW", "IPCG", "SWATINIT", "SWLX", "SWCRX", "SWUX", "SGLX", "SGCRX", "SGUX",
];

/// Those of the state of the fluids, which changes with time.
const STATE: &[&str] = &[
    "PRESSURE", "SWAT", "SGAS", "SOIL", "SSOLVENT", "SSOL", "SFOAM", "SPOLY", "SURF", "SALT",
    "SALTP", "RS", "RV", "RSW", "RVW", "RSSAT", "RVSAT", "PBUB", "PDEW", "TEMP", "TEMPI", "SOMAX",
    "SWMAX", "OILAPI", "GI",
];

/// Families of cell arrays by the start of their names: regions of a user's own, compositions.
const CELL_ARRAY_STARTS: &[&str] = &["FIP", "XMF", "YMF", "ZMF"];

/// Keywords of numbers that are no cell arrays, however many there are.
const TABLES: &[&str] = &[
    // Saturation functions.
    "SWOF", "SGOF", "SLGOF", "SWFN", "SGFN", "SOF2", "SOF3", "SOF32D", "SGWFN", "WSF", "GSF",
    "SWFNX", "SGFNX", "SSFN", "SORWMIS", "SGCWMIS", "MISC", "PMISC", "MSFN", "JFUNC", "ENPTVD",
    "ENKRVD", "IMPTVD", "IMKRVD", "ENPCVD", "TLMIXPAR", "EHYSTR", "STONE1EX", "SCALELIM",
    // Fluids and rock.
    "PVTO", "PVTG", "PVTW", "PVTWSALT", "PVTGW", "PVTGWO", "PVCO", "PVDO", "PVDG", "PVDS", "PVCDO",
    "PVZG", "SDENSITY", "DENSITY", "GRAVITY", "ROCK", "ROCKTAB", "ROCKTABH", "ROCK2D", "ROCK2DTR",
    "ROCKWNOD", "OVERBURD", "VISCREF", "WATVISCT", "OILVISCT", "GASVISCT", "WATDENT", "OILDENT",
    "GASDENT", "SPECHEAT", "SPECROCK", "RSCONST", "RSCONSTT", "PLYVISC", "PLYADS", "PLYROCK",
    "PLYMAX", "PLYSHEAR", "PLYSHLOG", "SURFST", "SURFVISC", "SURFADS", "SURFCAPD", "DIFFC",
    "SHRATE", "FOAMADS", "FOAMMOB", "FOAMROCK", "BDENSITY", "PERMFACT", "PCFACT", "SALTSOL",
    "SALTVD", "SALTPVD", "TRACER", // Components.
    "ACF", "BIC", "MW", "PCRIT", "TCRIT", "VCRIT", "ZCRIT", "SSHIFT", "PARACHOR", "OMEGAA",
    "OMEGAB", "STCOND", "ZI", "ZMFVD", "XMFVD", "YMFVD", "TEMPVD", "RTEMP", "RTEMPVD",
    // Initial state by depth.
    "EQUIL", "RSVD", "RVVD", "RSWVD", "RVWVD", "PBVD", "PDVD", "DATUM", "DATUMR", "VAPPARS",
    // Dimensions, vectors along an axis, single numbers.
    "TABDIMS", "EQLDIMS", "REGDIMS", "WELLDIMS", "AQUDIMS", "VFPPDIMS", "VFPIDIMS", "FAULTDIM",
    "GRIDOPTS", "ENDSCALE", "NSTACK", "NUMRES", "MINPV", "MINPORV", "MINDZNET", "DXV", "DYV",
    "DZV", "DRV", "DTHETAV", "INRAD", "OUTRAD", "NXFIN", "NYFIN", "NZFIN", "HXFIN", "HYFIN",
    "HZFIN", "START", "AQUCT", "AQUFETP", "AQUTAB", "AQUNUM", "RPTGRID", "RPTPROPS", "RPTSOL",
    "RPTREGS", "COORDSYS", "PINCH", "PINCHXY", "DRSDT", "DRVDT",
];

/// True where the keyword is known to give one value per cell.
pub fn is_cell_array(name: &str) -> bool {
    let is_family = |start: &&str| name.len() > start.len() && name.starts_with(*start);
    let is_known = CELL_ARRAYS.contains(&name) || is_state(name);
    is_known || !is_table(name) && CELL_ARRAY_STARTS.iter().any(is_family)
}

/// True of the state of the fluids, which a deck may give as it is at the start.
pub fn is_state(name: &str) -> bool {
    STATE.contains(&name)
}

/// True where the keyword is known to give a table or a vector.
pub fn is_table(name: &str) -> bool {
    TABLES.contains(&name)
}

/// True of numbers of regions, which files have as whole numbers. FIPOIL and the like are amounts of restarts.
pub fn is_region(name: &str) -> bool {
    let is_amount = ["FIPOIL", "FIPWAT", "FIPGAS"].contains(&name);
    is_cell_array(name) && !is_amount && (name.starts_with("FIP") || name.contains("NUM"))
}

/// What a cell has where a deck gives an array only in part; `None` where nothing is agreed on.
pub fn default_value(name: &str) -> Option<f64> {
    match name {
        "ACTNUM" | "NTG" | "SATNUM" | "PVTNUM" | "EQLNUM" | "FIPNUM" | "ROCKNUM" | "MULTNUM" => {
            Some(1.0)
        }
        _ => is_multiplier(name).then_some(1.0),
    }
}

/// True of factors on transmissibilities and pore volumes.
pub fn is_multiplier(name: &str) -> bool {
    name.starts_with("MULT") && name != "MULTNUM"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arrays_are_told_from_tables() {
        for name in ["PORO", "FIPNUM", "FIPZON", "ZMF_1", "MULTX-"] {
            assert!(is_cell_array(name) && !is_table(name), "{name}");
        }
        for name in ["SWOF", "PVDO", "ZMFVD", "DXV"] {
            assert!(is_table(name) && !is_cell_array(name), "{name}");
        }
        assert!(!is_cell_array("MYPROP") && !is_cell_array("FIP"));
        for (name, expected) in [
            ("SATNUM", true),
            ("FIPNUM", true),
            ("FIPZON", true),
            ("KRNUMX-", true),
            ("FIPOIL", false),
            ("PORO", false),
            ("AQUNUM", false),
        ] {
            assert_eq!(is_region(name), expected, "{name}");
        }
        assert_eq!(default_value("MULTZ-"), Some(1.0));
        assert_eq!(default_value("PORO"), None);
        assert!(is_multiplier("MULTPV") && !is_multiplier("MULTNUM"));
    }
}
