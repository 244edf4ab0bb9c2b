//! A setting in several values: one scene by each, measured against the truth of its own.

use serde_json::Value;

use super::light::{rays_of, reseeded};
use super::plan::{CPU, Contender, Plan, Source, Truth};
use crate::scene::{Scene, StrategyKind};
use crate::view::{NamedView, View};

/// A key of scenes and values for it.
#[derive(Debug, Clone, PartialEq)]
pub struct Sweep {
    /// Its path, with dots between the keys.
    pub key: String,
    /// The values, each once.
    pub values: Vec<Value>,
}

/// Why a scene does not have a key or a value; the sentence names both.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("--sweep {key}{problem}")]
pub struct SweepError {
    key: String,
    problem: String,
}

impl Sweep {
    /// Reads `KEY=V1,V2,...`. A value is a number, `true`, `false`, `null`, a list in brackets, or else a name.
    ///
    /// # Errors
    /// When there is no key, or no value.
    pub fn parse(text: &str) -> Result<Self, SweepError> {
        let error = |problem: &str| SweepError {
            key: text.to_owned(),
            problem: format!(": {problem}"),
        };
        let (key, values) = text
            .split_once('=')
            .ok_or_else(|| error("give a key and values like lighting.rays=4,16,64"))?;
        if key.split('.').any(|part| part.trim().is_empty()) {
            return Err(error("a key is missing before or between the dots"));
        }
        let mut found: Vec<Value> = Vec::new();
        for written in parts(values) {
            if written.is_empty() {
                return Err(error("a value is missing"));
            }
            let value = serde_json::from_str(written).unwrap_or_else(|_| written.into());
            if !found.contains(&value) {
                found.push(value);
            }
        }
        Ok(Self {
            key: key.trim().to_owned(),
            values: found,
        })
    }

    /// A scene with one of the values at the key. What is absent on the way there is as if it were empty.
    ///
    /// # Errors
    /// When scenes have no such key, or it does not take the value.
    pub fn applied(&self, scene: &Scene, value: &Value) -> Result<Scene, SweepError> {
        let error = |problem: String| SweepError {
            key: format!("{}={}", self.key, shown(value)),
            problem: format!(": {problem}"),
        };
        let mut written = serde_json::to_value(scene).map_err(|e| error(e.to_string()))?;
        let mut at = &mut written;
        for key in self.key.split('.') {
            if at.is_null() {
                *at = Value::Object(serde_json::Map::new());
            }
            at = match at {
                Value::Object(fields) => fields.entry(key).or_insert(Value::Null),
                Value::Array(items) => {
                    let number: Option<usize> = key.parse().ok();
                    let count = items.len();
                    number.and_then(|n| items.get_mut(n)).ok_or_else(|| {
                        error(format!("{key} is no number below {count} of a list"))
                    })?
                }
                _ => return Err(error(format!("there is nothing called {key} in a value"))),
            };
        }
        *at = value.clone();
        serde_json::from_value(written).map_err(|e| error(e.to_string()))
    }

    /// What a row is called.
    fn name(&self, value: &Value) -> String {
        let last = self.key.rsplit('.').next().unwrap_or(&self.key);
        format!("{last}={}", shown(value))
    }
}

/// A value as people write it.
fn shown(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        other => other.to_string(),
    }
}

/// Parts between commas that are in no bracket.
fn parts(text: &str) -> Vec<&str> {
    let (mut depth, mut first) = (0i32, 0);
    let mut parts = Vec::new();
    for (at, c) in text.char_indices() {
        match c {
            '[' | '{' => depth += 1,
            ']' | '}' => depth -= 1,
            ',' if depth == 0 => {
                parts.push(text[first..at].trim());
                first = at + 1;
            }
            _ => {}
        }
    }
    parts.push(text[first..].trim());
    parts
}

/// Why a sweep has no plan: of the sweep, or of a view.
#[derive(Debug, thiserror::Error)]
pub enum SweepPlanError<E> {
    /// A scene does not have the key or the value.
    #[error(transparent)]
    Sweep(#[from] SweepError),
    /// A view of a row's scene.
    #[error("{0}: {1}")]
    View(String, E),
}

impl Plan {
    /// A setting of a scene in several values, one row each, in the views that `views` makes of a scene. Each is
    /// measured against its own scene with light by many rays and by the accurate strategy, or where `uses_cpu` is true
    /// against the f64 reference of it.
    ///
    /// # Errors
    /// When a scene does not have the key or the value, and those of `views`.
    pub fn of_sweep<E>(
        sweep: &Sweep,
        scene: &Scene,
        uses_cpu: bool,
        frames: usize,
        views: impl Fn(&Scene) -> Result<Vec<NamedView>, E>,
    ) -> Result<Self, SweepPlanError<E>> {
        let mut plan = Self {
            views: Vec::new(),
            contenders: Vec::new(),
            truths: Vec::new(),
            frames,
        };
        for value in &sweep.values {
            let name = sweep.name(value);
            let own = sweep.applied(scene, value)?;
            if own.space != scene.space || own.size != scene.size {
                return Err(SweepError {
                    key: sweep.key.clone(),
                    problem: ": pictures of one comparison have one size and space".into(),
                }
                .into());
            }
            let drawn = |scene: &Scene| -> Result<Vec<NamedView>, SweepPlanError<E>> {
                views(scene).map_err(|e| SweepPlanError::View(format!("--sweep {name}"), e))
            };
            let named = drawn(&own)?;
            plan.views = named.iter().map(|v| v.name.clone()).collect();
            let by_rays = rays_of(&own);
            let of = |scene: &Scene| -> Result<Vec<View>, SweepPlanError<E>> {
                let accurate = |v: NamedView| v.view.by(StrategyKind::accurate());
                Ok(drawn(scene)?.into_iter().map(accurate).collect())
            };
            let truth = plan.truths.len();
            plan.contenders.push(Contender {
                setting: Some(name.clone()),
                views: named.into_iter().map(|v| v.view).collect(),
                truth,
                is_floor: false,
            });
            plan.truths.push(Truth {
                name: format!("{} {name}", if uses_cpu { CPU } else { "truth" }),
                source: match uses_cpu {
                    true => Source::Cpu(of(&by_rays)?),
                    false => Source::Executor(of(&by_rays)?),
                },
            });
            if !uses_cpu && own.lighting != by_rays.lighting {
                plan.contenders.push(Contender {
                    setting: Some(format!("truth again {name}")),
                    views: of(&reseeded(&by_rays))?,
                    truth,
                    is_floor: true,
                });
            }
        }
        Ok(plan)
    }
}
