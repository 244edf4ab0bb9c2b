//! Summary vectors over time: which ones are asked for, what was read of them, and that as a table.

use std::sync::Arc;

use crate::case::{Case, Measure, Units, Vector, Vectors};

/// Vectors of a selected well that are shown, where the case has them.
const OF_WELL: [&str; 7] = ["WOPR", "WWPR", "WGPR", "WWCT", "WBHP", "WWIR", "WGIR"];

/// Which vectors are asked for.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct VectorRequest {
    /// By name.
    pub names: Vec<String>,
    /// The usual ones of a well.
    pub well: Option<String>,
}

/// The vectors of a case, and those that were asked for over time.
pub struct VectorCurves {
    /// The case.
    pub case: Arc<Case>,
    /// Which ones were asked for.
    pub asked: VectorRequest,
    /// All that there are; else why there are none, in one sentence.
    pub vectors: Result<Arc<Vectors>, String>,
    /// Those asked for.
    pub curves: Vec<VectorCurve>,
}

/// A vector over time.
#[derive(Debug, Clone, PartialEq)]
pub struct VectorCurve {
    /// Which one.
    pub vector: Vector,
    /// A value for each time of [`Vectors`]; not a number before a run has the vector.
    pub values: Vec<f32>,
}

impl VectorCurve {
    fn is_zero(&self) -> bool {
        self.values.iter().all(|v| *v == 0.0 || v.is_nan())
    }
}

impl VectorCurves {
    /// Reads what is asked for; names that the case does not have are left out.
    pub fn read(case: Arc<Case>, asked: VectorRequest) -> Self {
        let vectors = match case.vectors() {
            Ok(Some(vectors)) => Ok(vectors),
            Ok(None) => Err("This case has no summary.".to_owned()),
            Err(error) => Err(error.to_string()),
        };
        let curves = vectors.as_ref().map_or_else(
            |_| Vec::new(),
            |vectors| {
                let mut curves = curves(vectors, &asked.names);
                if let Some(well) = &asked.well {
                    let names: Vec<_> = OF_WELL.iter().map(|k| format!("{k}:{well}")).collect();
                    let own = telling(self::curves(vectors, &names));
                    let is_new = |c: &VectorCurve| !asked.names.contains(&c.vector.name);
                    curves.extend(own.into_iter().filter(is_new));
                }
                curves
            },
        );
        Self {
            case,
            asked,
            vectors,
            curves,
        }
    }

    /// A row for each time with its date and days since the start, a column for each vector, as comma-separated
    /// text in some units.
    ///
    /// # Errors
    /// When it cannot be written; the sentence is for people.
    pub fn csv(&self, units: Units) -> Result<String, String> {
        let why = |e: &dyn std::fmt::Display| format!("the table cannot be written: {e}");
        let vectors = self.vectors.as_ref().map_err(String::clone)?;
        let mut writer = csv::Writer::from_writer(Vec::new());
        let measures = self.curves.iter().map(|c| units.of_vector(&c.vector));
        let measures: Vec<_> = measures.collect();
        let head = |(c, measure): (&VectorCurve, &Measure)| match measure.unit.as_str() {
            "" => c.vector.name.clone(),
            unit => format!("{} [{unit}]", c.vector.name),
        };
        let heads = ["date".to_owned(), "days".to_owned()].into_iter();
        writer
            .write_record(heads.chain(self.curves.iter().zip(&measures).map(head)))
            .map_err(|e| why(&e))?;
        for (n, days) in vectors.days.iter().enumerate() {
            // Times in files are such numbers.
            let time = [vectors.date(n), (*days as f32).to_string()].into_iter();
            let value = |(c, measure): (&VectorCurve, &Measure)| {
                let value = c.values.get(n).filter(|v| !v.is_nan());
                let value = value.map(|v| measure.show_single(*v));
                value.map_or_else(String::new, |v| v.to_string())
            };
            writer
                .write_record(time.chain(self.curves.iter().zip(&measures).map(value)))
                .map_err(|e| why(&e))?;
        }
        let bytes = writer.into_inner().map_err(|e| why(&e))?;
        String::from_utf8(bytes).map_err(|e| why(&e))
    }
}

fn curves(vectors: &Vectors, names: &[String]) -> Vec<VectorCurve> {
    let curve = |name: &String| {
        let place = vectors.find(name)?;
        Some(VectorCurve {
            vector: vectors.list[place].clone(),
            values: vectors.values(place).ok()?,
        })
    };
    names.iter().filter_map(curve).collect()
}

/// Of the vectors of a well those that tell something: no rates of production of an injector, none of injection of a
/// producer, and no gas where there is none.
fn telling(mut of_well: Vec<VectorCurve>) -> Vec<VectorCurve> {
    let injects = |c: &VectorCurve| c.vector.keyword.ends_with("IR");
    let is_pressure = |c: &VectorCurve| c.vector.keyword == "WBHP";
    let is_gas = |c: &VectorCurve| c.vector.keyword == "WGPR";
    let produces = of_well
        .iter()
        .any(|c| !injects(c) && !is_pressure(c) && !c.is_zero());
    of_well.retain(|c| match injects(c) || is_gas(c) {
        true => !c.is_zero(),
        false => produces || is_pressure(c),
    });
    of_well
}
