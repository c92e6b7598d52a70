//! JSON into the common tree.

use jsonc_parser::ast;
use jsonc_parser::common::Ranged;
use jsonc_parser::{CollectOptions, ParseOptions, parse_to_ast};

use super::value::{Key, Lines, Node, SyntaxError, Value};

/// Plain JSON; nothing beyond it.
const STRICT: ParseOptions = ParseOptions {
    allow_comments: false,
    allow_loose_object_property_names: false,
    allow_trailing_commas: false,
    allow_missing_commas: false,
    allow_single_quoted_strings: false,
    allow_hexadecimal_numbers: false,
    allow_unary_plus_numbers: false,
    allow_bare_decimal_point_numbers: false,
    allow_non_finite_numbers: false,
    allow_extended_string_escapes: false,
};

/// Reads a JSON document.
pub fn parse(text: &str) -> Result<Node, SyntaxError> {
    let lines = Lines::new(text);
    let parsed = parse_to_ast(text, &CollectOptions::default(), &STRICT);
    match parsed.map(|p| p.value) {
        Ok(Some(value)) => convert(&value, &lines),
        Ok(None) => Err(SyntaxError {
            line: 1,
            message: "it is empty".to_owned(),
        }),
        Err(error) => Err(SyntaxError {
            line: lines.at(error.range().start),
            message: error.kind().to_string(),
        }),
    }
}

fn convert(value: &ast::Value<'_>, lines: &Lines) -> Result<Node, SyntaxError> {
    let line = lines.at(value.range().start);
    let value = match value {
        ast::Value::StringLit(s) => Value::Text(s.value.clone().into_owned()),
        ast::Value::NumberLit(n) => Value::Number(n.value.parse().unwrap_or(f64::NAN)),
        ast::Value::BooleanLit(b) => Value::Bool(b.value),
        ast::Value::NullKeyword(_) => Value::Null,
        ast::Value::Array(a) => Value::List(
            a.elements
                .iter()
                .map(|e| convert(e, lines))
                .collect::<Result<_, _>>()?,
        ),
        ast::Value::Object(o) => {
            let mut entries: Vec<(Key, Node)> = Vec::new();
            let mut names = std::collections::HashSet::new();
            for property in &o.properties {
                let name = property.name.as_str().to_owned();
                let line = lines.at(property.range.start);
                if !names.insert(name.clone()) {
                    let message = format!("\"{name}\" stands here for the second time");
                    return Err(SyntaxError { line, message });
                }
                entries.push((Key { line, name }, convert(&property.value, lines)?));
            }
            Value::Table(entries)
        }
    };
    Ok(Node { line, value })
}
