//! Steps of a sample as names and values, for people and for programs.

use glam::{Vec2, Vec3A};
use serde_json::{Value, json};

use crate::engine::event::{Event, Letter};
use crate::engine::integrators::replay::{Step, VertexStep};
use crate::engine::math::Rgb;
use crate::engine::path::ClassId;
use crate::engine::plan::RenderPlan;
use crate::engine::scene::Scene;

/// What names the parts of a scene.
pub struct Naming<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// The layers.
    pub plan: &'a RenderPlan,
}

/// A step: its name, and its fields in the order in which they are read.
type Row = (&'static str, Vec<(&'static str, Value)>);

impl Naming<'_> {
    /// The step as a row.
    pub fn row(&self, step: &Step) -> Row {
        match *step {
            Step::Lens { p, d, film } => (
                "lens",
                vec![
                    ("film", pair(film)),
                    ("point", vector(p)),
                    ("direction", vector(d)),
                ],
            ),
            Step::Emission {
                light,
                p,
                d,
                pdf,
                flux,
            } => (
                "emission",
                vec![
                    ("light", json!(light)),
                    ("point", vector(p)),
                    ("direction", vector(d)),
                    ("pdf_point", optional(pdf.map(|pdf| pdf[0]))),
                    ("pdf_direction", optional(pdf.map(|pdf| pdf[1]))),
                    ("flux", color(flux)),
                ],
            ),
            Step::Vertex(vertex) => ("vertex", self.vertex(&vertex)),
            Step::Escaped { d } => ("escaped", vec![("direction", vector(d))]),
            Step::ShadowRay {
                light,
                pmf,
                wi,
                distance,
                pdf_dir,
            } => (
                "shadow ray",
                vec![
                    ("light", json!(light)),
                    ("probability", number(pmf)),
                    ("direction", vector(wi)),
                    ("distance", number(distance)),
                    ("pdf", number(pdf_dir)),
                ],
            ),
            Step::Read { from } => ("read", vec![("from", from.into())]),
            Step::Stored { power, class } => {
                let mut fields = vec![("power", color(power))];
                fields.extend(self.class(class));
                ("stored", fields)
            }
            Step::Ended { why } => ("ended", vec![("why", why.into())]),
            _ => self.found(step),
        }
    }

    /// Steps of light that is found, and of events.
    fn found(&self, step: &Step) -> Row {
        match *step {
            Step::Found {
                event,
                light,
                pdf_light,
                pdf_walk,
                weight,
                visible,
            } => (
                "found",
                vec![
                    ("event", json!(event.map(event_name))),
                    ("light", json!(light)),
                    ("pdf_light", optional(pdf_light)),
                    ("pdf_walk", optional(pdf_walk)),
                    ("weight", number(weight)),
                    ("visible", color(visible)),
                ],
            ),
            Step::Light {
                technique,
                film,
                class,
                weight,
                radiance,
            } => {
                let mut fields = vec![
                    ("s_t", json!(technique)),
                    ("film", film.map_or(Value::Null, pair)),
                    ("weight", optional(weight)),
                ];
                fields.extend(self.class(class));
                fields.push(("radiance", color(radiance)));
                ("light", fields)
            }
            Step::Scattered {
                event,
                wi,
                pdf_dir,
                weight,
            } => (
                "event",
                vec![
                    ("event", event_name(event).into()),
                    ("direction", vector(wi)),
                    ("pdf", number(pdf_dir)),
                    ("weight", weight.map_or(Value::Null, color)),
                ],
            ),
            Step::Roulette {
                number: u,
                survived,
                throughput,
            } => (
                "roulette",
                vec![
                    ("number", number(u)),
                    ("survived", survived.into()),
                    ("throughput", color(throughput)),
                ],
            ),
            // `row` has the others.
            _ => ("", Vec::new()),
        }
    }

    fn vertex(&self, v: &VertexStep) -> Vec<(&'static str, Value)> {
        let material = v
            .material
            .and_then(|m| self.scene.material_names.get(m as usize));
        let densities = |i: usize| optional(v.densities.map(|d| d[i]));
        let mut fields = vec![
            ("point", vector(v.p)),
            (
                "normal",
                if v.material.is_some() {
                    vector(v.n)
                } else {
                    Value::Null
                },
            ),
            ("toward_before", vector(v.wo)),
            ("distance", number(v.t)),
            ("material", json!(material)),
            (
                "medium",
                if v.material.is_none() {
                    json!(true)
                } else {
                    Value::Null
                },
            ),
            ("primitive", json!(v.prim)),
            ("light", json!(v.light)),
            ("throughput", color(v.throughput)),
            ("pdf", densities(0)),
            ("pdf_other_walk", densities(1)),
        ];
        fields.extend(self.class(v.class));
        fields
    }

    /// A class: its number and the layers its words belong to.
    fn class(&self, class: ClassId) -> [(&'static str, Value); 2] {
        let layers = self.plan.classes.layers(class);
        let labels = self.plan.labels.iter().enumerate();
        let labels: Vec<&String> = labels
            .filter(|(i, _)| layers & (1 << i) != 0)
            .map(|(_, label)| label)
            .collect();
        [("class", class.to_byte().into()), ("layers", json!(labels))]
    }
}

fn event_name(event: Event) -> String {
    match (event, event.letter()) {
        (Event::Specular(lobe), _) => format!("S{lobe}"),
        (_, Letter::D) => "D".to_owned(),
        (_, Letter::G) => "G".to_owned(),
        (_, Letter::S) => "S".to_owned(),
        (_, Letter::V) => "V".to_owned(),
    }
}

/// The shortest decimal that reads back as `x`; what is no number is a word.
fn number(x: f32) -> Value {
    let text = x.to_string();
    match text.parse::<f64>() {
        Ok(x) if x.is_finite() => json!(x),
        _ => text.into(),
    }
}

fn optional(x: Option<f32>) -> Value {
    x.map_or(Value::Null, number)
}

fn pair(v: Vec2) -> Value {
    v.to_array().map(number).to_vec().into()
}

fn vector(v: Vec3A) -> Value {
    v.to_array().map(number).to_vec().into()
}

/// A colour as three numbers.
pub fn color(c: Rgb) -> Value {
    c.to_array().map(number).to_vec().into()
}

/// A value as a person reads it.
pub fn plain(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        Value::Array(all) => {
            let all: Vec<String> = all.iter().map(plain).collect();
            format!("({})", all.join(" "))
        }
        // JSON writes very large and very small numbers out in full, or in its own way.
        Value::Number(n) => n.as_f64().filter(|_| n.is_f64()).map_or_else(
            || n.to_string(),
            |x| {
                let x = x as f32;
                match x.abs() {
                    0.0 => "0".to_owned(),
                    a if (1e-4..1e7).contains(&a) => x.to_string(),
                    _ => format!("{x:e}"),
                }
            },
        ),
        other => other.to_string(),
    }
}
