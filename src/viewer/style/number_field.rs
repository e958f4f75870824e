//! Fields in which a number is typed or dragged. A text that is no number, or is
//! out of range, draws a complaint.

use crate::viewer::style::numbers::digits;
use egui::{Context, DragValue, Id, Key, Response, Ui, Vec2};
use std::cell::RefCell;

/// Format of a number.
#[derive(Clone, Copy)]
pub(crate) enum Written {
    /// With this number of significant digits.
    Digits(usize),
    /// Without a fraction.
    Whole,
}

/// A field for one number.
pub(crate) struct NumberField<'a> {
    /// Its name in complaints.
    pub(crate) name: &'a str,
    pub(crate) range: [f64; 2],
    /// Amount that a drag by one point adds.
    pub(crate) speed: f64,
    pub(crate) written: Written,
    /// Before the number, with its space.
    pub(crate) prefix: &'a str,
    /// Behind the number, with its space.
    pub(crate) unit: &'a str,
    /// Size in points.
    pub(crate) size: Vec2,
}

/// Fault of a text.
enum Wrong {
    NoNumber(String),
    Beyond(String, f64),
}

impl NumberField<'_> {
    /// Draws it. The value changes once the field is left or dragged, never beyond the range.
    pub(crate) fn ui(self, ui: &mut Ui, value: &mut f64) -> Response {
        let NumberField { range: [low, high], written, prefix, unit, .. } = self;
        let write = move |x: f64| match written {
            Written::Digits(n) => digits(x, n),
            Written::Whole => format!("{x:.0}"),
        };
        let (exact, shown) = (*value, write(*value));
        let wrong = RefCell::new(None);
        let parse = |text: &str| {
            let text = text.trim();
            let bare = text.strip_suffix(unit.trim()).unwrap_or(text).trim();
            // A text that was not changed is the number itself, not its rounded form: to look is not to
            // edit.
            if bare == shown {
                return Some(exact);
            }
            // The decimal comma of many keyboards.
            let number = bare.replace(',', ".").parse().ok().filter(|x: &f64| !x.is_nan());
            match number {
                None if bare.is_empty() => {}
                None => *wrong.borrow_mut() = Some(Wrong::NoNumber(bare.to_owned())),
                Some(x) if (low..=high).contains(&x) => {}
                Some(x) => {
                    let end = x.clamp(low, high);
                    *wrong.borrow_mut() = Some(Wrong::Beyond(bare.to_owned(), end));
                }
            }
            match written {
                Written::Digits(_) => number,
                Written::Whole => number.map(f64::round),
            }
        };
        let field = DragValue::new(value)
            .range(low..=high)
            .clamp_existing_to_range(false)
            .speed(self.speed)
            .prefix(prefix)
            .suffix(unit)
            .update_while_editing(false)
            .max_decimals(if let Written::Whole = written { 0 } else { 12 })
            .custom_formatter(|x, _| write(x))
            .custom_parser(parse)
            .min_size(self.size);
        let response = ui.add_sized(self.size, field);
        // A field is taken to lose the keyboard in the frame after Escape, too, and then to mean what was
        // typed: it does not.
        let left = response.id.with("left by Escape");
        if ui.data_mut(|d| d.remove_temp::<bool>(left)).is_some() {
            *value = exact;
            return response;
        }
        if response.lost_focus() && ui.input(|i| i.key_pressed(Key::Escape)) {
            ui.data_mut(|d| d.insert_temp(left, true));
        }
        if let Some(wrong) = wrong.into_inner() {
            let name = self.name;
            let complaint = match wrong {
                Wrong::NoNumber(text) => {
                    format!("{name}: \"{text}\" is no number; it stays as it was")
                }
                Wrong::Beyond(text, end) => format!(
                    "{name}: {text} is out of range, which is {} to {}{unit}; {} was taken",
                    plain(low),
                    plain(high),
                    plain(end)
                ),
            };
            complain(ui.ctx(), complaint);
        }
        response
    }

    /// Draws the field for a whole number.
    pub(crate) fn whole(self, ui: &mut Ui, value: &mut u64) -> Response {
        let mut wide = *value as f64;
        let field = NumberField { written: Written::Whole, ..self };
        let response = field.ui(ui, &mut wide);
        if wide != *value as f64 {
            *value = wide as u64;
        }
        response
    }
}

/// The end of a range: exact, and short.
fn plain(x: f64) -> String {
    if x == 0.0 || (1e-5..1e7).contains(&x.abs()) { format!("{x}") } else { format!("{x:e}") }
}

fn complaint_id() -> Id {
    Id::unique("what was wrong with a number")
}

/// Leaves a complaint about a number, which the app shows.
pub(crate) fn complain(ctx: &Context, complaint: String) {
    ctx.data_mut(|d| d.insert_temp(complaint_id(), complaint));
}

/// The complaint about the number typed last, once.
pub(crate) fn take_complaint(ctx: &Context) -> Option<String> {
    ctx.data_mut(|d| d.remove_temp(complaint_id()))
}
