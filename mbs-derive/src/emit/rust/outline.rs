//! A long module for review: signatures, documentation and operation counts, and of every long body a digest.

use quote::ToTokens;

/// Bodies of more bytes than this are left out.
const LONG: usize = 400;

/// Leaves out the long bodies of all functions, whose documentation then ends with a digest of what was there.
pub(super) fn leave_out_bodies(items: &mut [syn::Item]) {
    for item in items {
        match item {
            syn::Item::Mod(syn::ItemMod { attrs, content: Some((_, items)), .. }) => {
                // Without bodies the key to their locals says nothing.
                let (mut docs, is_doc) = (0, |attribute: &syn::Attribute| attribute.path().is_ident("doc"));
                attrs.retain(|attribute| !is_doc(attribute) || std::mem::replace(&mut docs, 1) == 0);
                leave_out_bodies(items);
            }
            syn::Item::Impl(block) => block.items.iter_mut().for_each(leave_out_body),
            _ => {}
        }
    }
}

/// Leaves out the implementations of mbs-runtime's traits: the documentation of the mechanism names these.
pub(super) fn leave_out_forwarders(items: &mut Vec<syn::Item>) {
    items.retain(|item| !matches!(item, syn::Item::Impl(block) if is_of_the_runtime(block)));
    for item in items {
        if let syn::Item::Mod(syn::ItemMod { content: Some((_, items)), .. }) = item {
            leave_out_forwarders(items);
        }
    }
}

/// Whether it implements a trait of mbs-runtime.
fn is_of_the_runtime(block: &syn::ItemImpl) -> bool {
    let of = |path: &syn::Path| path.segments.first().is_some_and(|crate_| crate_.ident == "mbs_runtime");
    block.trait_.as_ref().is_some_and(|(path, _)| of(path))
}

fn leave_out_body(item: &mut syn::ImplItem) {
    let syn::ImplItem::Fn(function) = item else { return };
    let body = function.block.to_token_stream().to_string();
    if body.len() <= LONG {
        return;
    }
    let digest = format!(" Digest of the body: {:016x}.", digest(body.as_bytes()));
    function.attrs.push(syn::parse_quote!(#[doc = ""]));
    function.attrs.push(syn::parse_quote!(#[doc = #digest]));
    function.block = syn::parse_quote!({});
}

/// 64 bits by FNV-1a (Fowler, Noll, Vo, 1991).
fn digest(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |hash, &byte| (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3))
}

#[cfg(test)]
mod tests {
    use super::digest;

    /// Vectors of the authors' test suite.
    #[test]
    fn digests_are_those_of_fnv_1a() {
        assert_eq!(digest(b""), 0xcbf2_9ce4_8422_2325);
        assert_eq!(digest(b"a"), 0xaf63_dc4c_8601_ec8c);
        assert_eq!(digest(b"foobar"), 0x8594_4171_f739_67e8);
    }
}
