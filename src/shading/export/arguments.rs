//! The names of arguments, which naga makes unique over a whole module.

use naga::Module;

/// The functions of a text that naga has written, each with what stands before it.
pub(super) fn functions(text: &str) -> impl Iterator<Item = &str> {
    text.split_inclusive("\n}\n")
}

/// A text that naga has written, in which each function's arguments have the names that they have in WGSL.
///
/// naga's are the same with an underscore and perhaps a number after them. A name that the function has for something
/// else, or that naga keeps away from as a keyword, stays as naga writes it.
pub(super) fn with_their_names(module: &Module, text: &str) -> String {
    let renamed = functions(text).map(|text| {
        let mut all = module.functions.iter().map(|(_, function)| function);
        let of_text = all.find(|function| words(signature(text)).any(|word| Some(word) == function.name.as_deref()));
        of_text.map_or(text.to_owned(), |function| renamed(function, text))
    });
    renamed.collect()
}

fn renamed(function: &naga::Function, text: &str) -> String {
    let names = function.arguments.iter().filter_map(|argument| argument.name.as_deref());
    names.fold(text.to_owned(), |text, name| {
        let word = words(signature(&text)).find(|word| is_naga_s(word, name)).map(str::to_owned);
        match word {
            Some(word) if words(&text).all(|other| other != name) => replace_word(&text, &word, name),
            _ => text,
        }
    })
}

/// Whether naga makes this word of a name to have it unique.
fn is_naga_s(word: &str, name: &str) -> bool {
    match word.strip_prefix(name).and_then(|rest| rest.strip_prefix('_')) {
        None => false,
        // After a letter an underscore alone keeps away from a keyword.
        Some("") => name.ends_with(|last: char| last.is_ascii_digit()),
        Some(number) => number.bytes().all(|byte| byte.is_ascii_digit()),
    }
}

/// What stands before a function's body.
fn signature(text: &str) -> &str {
    text.split('{').next().unwrap_or_default()
}

/// The names and numbers of a text.
fn words(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| !is_of_word(c)).filter(|word| !word.is_empty())
}

fn replace_word(text: &str, word: &str, by: &str) -> String {
    let mut result = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(at) = rest.find(is_of_word) {
        let end = rest[at..].find(|c| !is_of_word(c)).map_or(rest.len(), |length| at + length);
        result += &rest[..at];
        result += if &rest[at..end] == word { by } else { &rest[at..end] };
        rest = &rest[end..];
    }
    result + rest
}

fn is_of_word(c: char) -> bool {
    c.is_ascii_alphanumeric() || c == '_'
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whole_words_are_replaced() {
        assert_eq!(replace_word("n_1 + dp1_.x * n_1;", "n_1", "n"), "n + dp1_.x * n;");
        assert_eq!(replace_word("n_12 + an_1", "n_1", "n"), "n_12 + an_1");
    }

    #[test]
    fn arguments_get_their_names_where_those_are_free() {
        let (module, _) =
            super::super::translate::parsed("fn f(s: f32, out: f32, k1: f32) -> f32 { return s + out + k1; }");
        let text = "float f(float s_1, float out_, float k1_) {\n    return ((s_1 + out_) + k1_);\n}\n";
        let expected = "float f(float s, float out_, float k1) {\n    return ((s + out_) + k1);\n}\n";
        assert_eq!(with_their_names(&module, text), expected);
        // Here s is a component, and nothing is renamed to it.
        let text = "float f(float s_1, float out_, float k1) {\n    return s_1 + v.s;\n}";
        assert_eq!(with_their_names(&module, text), text);
    }
}
