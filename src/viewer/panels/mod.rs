//! The panels beside the picture and below it: one file each, all of one form.

pub(crate) mod compare;
pub(crate) mod controls;
pub(crate) mod energy;
pub(crate) mod error;
pub(crate) mod export;
pub(crate) mod files;
pub(crate) mod kept;
pub(crate) mod lobe;
pub(crate) mod materials;
pub(crate) mod method;
pub(crate) mod pixel;
pub(crate) mod proofs;
pub(crate) mod report;
pub(crate) mod sheet;
pub(crate) mod status;
pub(crate) mod tracing;
pub(crate) mod view;

use crate::viewer::document::Document;
use crate::viewer::keys::Action;
use egui::Ui;

/// A part of the window that shows the document and changes it.
pub(crate) trait Panel {
    /// Draws the panel. What can be set about the picture is edited in the document, of which
    /// [`Live`](crate::viewer::document::live::Live) is only read; all else is asked for by actions, done at
    /// the end of the frame.
    fn ui(&mut self, ui: &mut Ui, document: &mut Document, actions: &mut Vec<Action>);
}

/// The panels of the side, and a loop over them, from the one list below.
macro_rules! side {
    ($($name:ident: $panel:ty,)*) => {
        /// The panels of the side, from top to bottom.
        #[derive(Default)]
        pub(crate) struct SidePanels {
            $(pub(crate) $name: $panel,)*
        }

        impl SidePanels {
            /// The panels in the order in which they are drawn.
            pub(crate) fn all(&mut self) -> impl Iterator<Item = &mut dyn Panel> {
                let panels: [&mut dyn Panel; _] = [$(&mut self.$name,)*];
                panels.into_iter()
            }
        }
    };
}

// A new panel is one more line here.
side! {
    controls: controls::Controls,
    sheet: sheet::SheetButton,
    compare: compare::Compare,
    files: files::Files,
    lobe: lobe::LobePanel,
    pixel: pixel::PixelPanel,
    materials: materials::Materials,
    view: view::View,
    error: error::ErrorPanel,
    tracing: tracing::TracingPanel,
    kept: kept::KeptPanel,
    method: method::MethodPanel,
    report: report::ReportPanel,
    // Last, for it grows when its proofs are done.
    proofs: proofs::Proofs,
}
