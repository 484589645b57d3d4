(** * The greatest of a linear function of the filters

    One axis of the paper's cascade in continuous time, from rest:
    u_f' = - k_f (u_f - u_s), u_s' = - k_s (u_s - ubar) with |ubar| <= M.
    Accelerations in m/s^2, bandwidths in 1/s. What [Reachable] rests on.

    The input may jump at finitely many times before the time T of interest, as
    an input held from tick to tick does: there u_s has a corner. *)

From Coq Require Import Reals Lra List.
From Coquelicot Require Import Coquelicot.
From SaturatedHybrid Require Import Space.
Open Scope R_scope.

(** What is continuous, and does not fall where it has a derivative, does not
    fall. *)
Lemma does_not_fall_over_corners : forall (f df : R -> R) (jumps : list R) a b, a <= b ->
  (forall s, a <= s <= b -> continuity_pt f s) ->
  (forall s, a < s < b -> ~ In s jumps -> is_derive f s (df s) /\ 0 <= df s) -> f a <= f b.
Proof.
  intros f df jumps. induction jumps as [|jump rest IH]; intros a b Hab Hcont Hd.
  - destruct (Req_dec a b) as [->|Hne]; [lra|].
    assert (pr1 : forall c, a < c < b -> derivable_pt f c).
    { intros c Hc. exists (df c). apply is_derive_Reals. now apply (Hd c Hc). }
    assert (pr2 : forall c, a < c < b -> derivable_pt id c) by (intros; apply derivable_pt_id).
    destruct (MVT f id a b pr1 pr2) as (c & Hc & H); [lra | exact Hcont | |].
    { intros c _. apply derivable_continuous_pt, derivable_pt_id. }
    destruct (Hd c Hc) as (Hdc & Hpos); [now intros []|].
    assert (E : derive_pt f c (pr1 c Hc) = df c) by (apply derive_pt_eq_0; now apply is_derive_Reals).
    assert (E' : derive_pt id c (pr2 c Hc) = 1) by (apply derive_pt_eq_0, derivable_pt_lim_id).
    rewrite E, E' in H. unfold id in H.
    assert (0 <= (b - a) * df c) by (apply Rmult_le_pos; lra). lra.
  - assert (Hpart : forall c d, a <= c <= d -> d <= b -> (jump <= c \/ d <= jump) -> f c <= f d).
    { intros c d Hc Hdb Hj. apply IH; [lra | intros s Hs; apply Hcont; lra |].
      intros s Hs Hn. apply Hd; [lra|]. intros [->|Hin]; [lra | now apply Hn]. }
    destruct (Rlt_dec a jump) as [Ha|Ha]; [|apply Hpart; lra].
    destruct (Rlt_dec jump b) as [Hb|Hb]; [|apply Hpart; lra].
    apply Rle_trans with (f jump); apply Hpart; lra.
Qed.

Section Axis.

Variables (k_f k_s M : R).
Hypothesis bandwidths : 0 < k_f /\ 0 < k_s.

(** A flight from rest until T. *)
Definition flight (u_f u_s ubar : R -> R) (jumps : list R) (T : R) : Prop :=
  0 <= T /\ u_f 0 = 0 /\ u_s 0 = 0 /\
  (forall s, 0 <= s <= T -> continuity_pt u_f s /\ continuity_pt u_s s) /\
  (forall s, 0 < s < T -> - M <= ubar s <= M) /\
  (forall s, 0 < s < T -> ~ In s jumps ->
     is_derive u_f s (- (k_f * (u_f s - u_s s))) /\ is_derive u_s s (- (k_s * (u_s s - ubar s)))).

Lemma mirrored : forall u_f u_s ubar jumps T, flight u_f u_s ubar jumps T ->
  flight (fun s => - u_f s) (fun s => - u_s s) (fun s => - ubar s) jumps T.
Proof.
  intros u_f u_s ubar jumps T (HT & Hf & Hs & Hc & Hu & Hd). unfold flight.
  split; [exact HT|]. split; [rewrite Hf; ring|]. split; [rewrite Hs; ring|]. split; [|split].
  - intros s H. destruct (Hc s H). split; [apply (continuity_pt_opp u_f) | apply (continuity_pt_opp u_s)]; assumption.
  - intros s H. specialize (Hu s H). lra.
  - intros s H Hn. destruct (Hd s H Hn) as (H1 & H2). split.
    + replace (- (k_f * (- u_f s - - u_s s))) with (- - (k_f * (u_f s - u_s s))) by ring. now apply derive_opposite.
    + replace (- (k_s * (- u_s s - - ubar s))) with (- - (k_s * (u_s s - ubar s))) by ring. now apply derive_opposite.
Qed.

(** ** The greatest of a linear function of the state

    G and W are the adjoint's two weights: G (u_f - u_s) + W u_s changes at the
    rate k_s (W - G) ubar. The sign of W - G changes once, at c. *)

Section Adjoint.

Variables (u_f u_s ubar : R -> R) (jumps : list R) (T : R).
Hypothesis flown : flight u_f u_s ubar jumps T.
Variables (G W : R -> R) (c : R).
Hypothesis G_moves : forall s, is_derive G s (k_f * G s).
Hypothesis W_moves : forall s, is_derive W s (- (k_s * (G s - W s))).
Hypothesis G_positive : forall s, 0 <= G s.
Hypothesis meeting : W c = G c /\ c <= T.

Lemma smooth_continuous : forall (f : R -> R) s l, is_derive f s l -> continuity_pt f s.
Proof. intros f s l H. apply derivable_continuous_pt. exists l. now apply is_derive_Reals. Qed.

(** (G - W) e^(- k_s s) does not fall. *)
Lemma G_passes_W : forall r s, r <= s -> (G r - W r) * exp (- (k_s * r)) <= (G s - W s) * exp (- (k_s * s)).
Proof.
  intros r s Hrs.
  assert (Hd : forall q, is_derive (fun p => (G p - W p) * exp (- (k_s * p))) q (k_f * G q * exp (- (k_s * q)))).
  { intros q. pose proof (G_moves q) as HG. pose proof (W_moves q) as HW.
    auto_derive; [repeat split; try (eexists; eassumption); exact I|].
    rewrite (is_derive_unique (fun x : R => G x) q _ HG : Derive (fun x : R => G x) q = _),
      (is_derive_unique (fun x : R => W x) q _ HW : Derive (fun x : R => W x) q = _). ring. }
  apply (does_not_fall_over_corners (fun p => (G p - W p) * exp (- (k_s * p)))
    (fun q => k_f * G q * exp (- (k_s * q))) nil r s Hrs).
  - intros q _. apply (smooth_continuous _ q _ (Hd q)).
  - intros q _ _. split; [apply Hd|]. pose proof (G_positive q). pose proof (exp_pos (- (k_s * q))).
    apply Rmult_le_pos; [apply Rmult_le_pos|]; lra.
Qed.

Lemma before : forall s, s <= c -> G s <= W s.
Proof.
  intros s Hs. pose proof (G_passes_W s c Hs) as H. rewrite (proj1 meeting) in H.
  apply Rmult_le_reg_r with (exp (- (k_s * s))); [apply exp_pos|]. lra.
Qed.

Lemma after : forall s, c <= s -> W s <= G s.
Proof.
  intros s Hs. pose proof (G_passes_W c s Hs) as H. rewrite (proj1 meeting) in H.
  apply Rmult_le_reg_r with (exp (- (k_s * s))); [apply exp_pos|]. lra.
Qed.

(** The function, with sigma M W added: it falls while (ubar + sigma M) (W - G)
    is not positive. *)
Lemma falls : forall sigma a b, 0 <= a <= b -> b <= T ->
  (forall s, a < s < b -> - M <= ubar s <= M -> (ubar s + sigma * M) * (W s - G s) <= 0) ->
  G b * (u_f b - u_s b) + W b * u_s b + sigma * M * W b <=
  G a * (u_f a - u_s a) + W a * u_s a + sigma * M * W a.
Proof.
  intros sigma a b Ha Hb Hsign. destruct flown as (_ & _ & _ & Hc & Hu & Hd).
  assert (H : - (G a * (u_f a - u_s a) + W a * u_s a + sigma * M * W a) <=
              - (G b * (u_f b - u_s b) + W b * u_s b + sigma * M * W b)); [|lra].
  apply (does_not_fall_over_corners
    (fun s => - (G s * (u_f s - u_s s) + W s * u_s s + sigma * M * W s))
    (fun s => - (k_s * ((ubar s + sigma * M) * (W s - G s)))) jumps a b (proj2 Ha)).
  - intros s Hs. destruct (Hc s ltac:(lra)) as (H1 & H2).
    pose proof (smooth_continuous G s _ (G_moves s)) as H3.
    pose proof (smooth_continuous W s _ (W_moves s)) as H4.
    exact (continuity_pt_opp _ s (continuity_pt_plus _ _ s (continuity_pt_plus _ _ s
      (continuity_pt_mult _ _ s H3 (continuity_pt_minus _ _ s H1 H2)) (continuity_pt_mult _ _ s H4 H2))
      (continuity_pt_mult _ _ s (continuity_pt_const (fun _ => sigma * M) s (fun _ _ => eq_refl)) H4))).
  - intros s Hs Hn. destruct (Hd s ltac:(lra) Hn) as (H1 & H2).
    specialize (Hsign s Hs (Hu s ltac:(lra))). split.
    + pose proof (G_moves s) as H3. pose proof (W_moves s) as H4.
      auto_derive; [repeat split; try (eexists; eassumption); exact I|].
      rewrite (is_derive_unique (fun x : R => G x) s _ H3 : Derive (fun x : R => G x) s = _),
        (is_derive_unique (fun x : R => W x) s _ H4 : Derive (fun x : R => W x) s = _),
        (is_derive_unique (fun x : R => u_f x) s _ H1 : Derive (fun x : R => u_f x) s = _),
        (is_derive_unique (fun x : R => u_s x) s _ H2 : Derive (fun x : R => u_s x) s = _). ring.
    + apply (Rmult_le_compat_l k_s) in Hsign; lra.
Qed.

(** For inputs of at most M. *)
Theorem greatest_linear_function : 0 <= M -> G T * (u_f T - u_s T) + W T * u_s T <= M * (2 * G c - W T).
Proof.
  intros HM. pose proof flown as (HT & Hf & Hs & _).
  assert (Hlate : forall a, 0 <= a <= T -> c <= a ->
    G T * (u_f T - u_s T) + W T * u_s T + 1 * M * W T <= G a * (u_f a - u_s a) + W a * u_s a + 1 * M * W a).
  { intros a Ha Hca. apply falls; try lra. intros s Hs1 Hu. pose proof (after s ltac:(lra)).
    assert (0 <= (ubar s + 1 * M) * (G s - W s)) by (apply Rmult_le_pos; lra). lra. }
  destruct (Rle_dec 0 c) as [Hc0|Hc0].
  - pose proof (Hlate c ltac:(lra) ltac:(lra)) as H1.
    assert (H2 : G c * (u_f c - u_s c) + W c * u_s c + -1 * M * W c <=
      G 0 * (u_f 0 - u_s 0) + W 0 * u_s 0 + -1 * M * W 0).
    { apply falls; try lra. intros s Hs1 Hu. pose proof (before s ltac:(lra)).
      assert (0 <= (M - ubar s) * (W s - G s)) by (apply Rmult_le_pos; lra). lra. }
    rewrite Hf, Hs in H2. pose proof (before 0 Hc0). pose proof (G_positive 0).
    assert (0 <= M * W 0) by (apply Rmult_le_pos; lra). rewrite (proj1 meeting) in H1, H2. lra.
  - pose proof (Hlate 0 ltac:(lra) ltac:(lra)) as H1. rewrite Hf, Hs in H1.
    assert (H2 : - W c <= - W 0).
    { apply (does_not_fall_over_corners (fun s => - W s) (fun s => k_s * (G s - W s)) nil c 0 ltac:(lra)).
      - intros s _. apply (continuity_pt_opp W). apply (smooth_continuous W s _ (W_moves s)).
      - intros s Hs1 _. split.
        + replace (k_s * (G s - W s)) with (- - (k_s * (G s - W s))) by ring. apply derive_opposite, W_moves.
        + pose proof (after s ltac:(lra)). apply Rmult_le_pos; lra. }
    rewrite (proj1 meeting) in H2. pose proof (G_positive c).
    assert (M * W 0 <= M * (2 * G c)) by (apply Rmult_le_compat_l; lra). lra.
Qed.

End Adjoint.
End Axis.
