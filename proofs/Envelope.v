(** * The envelope is invariant

    Section 3 of docs/extended-law.md, claim (c), in continuous time;
    controller-core/src/extended/direction_limiter.rs. *)

From Coq Require Import Reals Lra.
From Coquelicot Require Import Coquelicot.
From SaturatedHybrid Require Import Space Limiter.
Open Scope R_scope.

(** A function whose derivative is not negative does not fall. *)
Lemma does_not_fall : forall (f df : R -> R) a b, a <= b ->
  (forall s, a <= s <= b -> is_derive f s (df s)) ->
  (forall s, a < s < b -> 0 <= df s) -> f a <= f b.
Proof.
  intros f df a b Hab Hd Hpos.
  destruct (Req_dec a b) as [->|Hne]; [lra|].
  assert (Hlt : a < b) by lra.
  destruct (MVT_cor2 f df a b Hlt) as (c & Hc & Hin).
  - intros s Hs. apply is_derive_Reals. now apply Hd.
  - specialize (Hpos c Hin). assert (0 <= df c * (b - a)) by (apply Rmult_le_pos; lra). lra.
Qed.

(** c_z >= -A_-, and |u| <= U: y is c_z + A_-, or U - |u|. Both limits leave
    y'' >= -2 k y' - k^2 y, and both start with y > 0, y' + k y >= 0: for |u| that
    is rho . u' <= k (U - |u|). U is constant here: the thrust scale is at rest.
    The limit on |u| has the last word, so the one on c_z acts as written only
    while that does nothing, as it does wherever |u| is below U and not about to
    pass it. *)
Theorem stays_inside : forall (y y_1 y_2 : R -> R) k,
  (forall s, 0 <= s -> is_derive y s (y_1 s)) ->
  (forall s, 0 <= s -> is_derive y_1 s (y_2 s)) ->
  (forall s, 0 <= s -> - (2 * k * y_1 s) - k * k * y s <= y_2 s) ->
  0 < y 0 -> 0 <= y_1 0 + k * y 0 ->
  forall t, 0 <= t -> 0 < y t.
Proof.
  intros y y_1 y_2 k Hy Hy1 Hlimit Hstart Hrate t Ht.
  assert (Hfirst : forall s, 0 <= s -> 0 <= y_1 s + k * y s).
  { intros s Hs.
    assert (Hle : (y_1 0 + k * y 0) * exp (k * 0) <= (y_1 s + k * y s) * exp (k * s)).
    { apply (does_not_fall (fun r => (y_1 r + k * y r) * exp (k * r))
        (fun r => (y_2 r + k * y_1 r) * exp (k * r) + (y_1 r + k * y r) * (k * exp (k * r))) 0 s Hs).
      - intros r Hr. specialize (Hy r (proj1 Hr)). specialize (Hy1 r (proj1 Hr)).
        auto_derive; [repeat split; try (eexists; eassumption); exact I|].
        rewrite (is_derive_unique (fun x : R => y x) r _ Hy : Derive (fun x : R => y x) r = _),
          (is_derive_unique (fun x : R => y_1 x) r _ Hy1 : Derive (fun x : R => y_1 x) r = _). ring.
      - intros r Hr. specialize (Hlimit r ltac:(lra)).
        replace ((y_2 r + k * y_1 r) * exp (k * r) + (y_1 r + k * y r) * (k * exp (k * r)))
          with ((y_2 r + 2 * k * y_1 r + k * k * y r) * exp (k * r)) by ring.
        apply Rmult_le_pos; [lra | left; apply exp_pos]. }
    rewrite Rmult_0_r, exp_0, Rmult_1_r in Hle.
    apply Rmult_le_reg_r with (exp (k * s)); [apply exp_pos|]. lra. }
  assert (Hle : y 0 * exp (k * 0) <= y t * exp (k * t)).
  { apply (does_not_fall (fun r => y r * exp (k * r)) (fun r => (y_1 r + k * y r) * exp (k * r)) 0 t Ht).
    - intros r Hr. specialize (Hy r (proj1 Hr)).
      auto_derive; [repeat split; try (eexists; eassumption); exact I|].
      rewrite (is_derive_unique (fun x : R => y x) r _ Hy : Derive (fun x : R => y x) r = _). ring.
    - intros r Hr. apply Rmult_le_pos; [apply Hfirst; lra | left; apply exp_pos]. }
  rewrite Rmult_0_r, exp_0, Rmult_1_r in Hle.
  apply Rmult_lt_reg_r with (exp (k * t)); [apply exp_pos|]. lra.
Qed.

(** What does not grow where it is positive never becomes positive. *)
Theorem never_positive : forall (g dg : R -> R),
  (forall s, 0 <= s -> is_derive g s (dg s)) ->
  (forall s, 0 <= s -> 0 < g s -> dg s <= 0) ->
  g 0 <= 0 -> forall t, 0 <= t -> g t <= 0.
Proof.
  intros g dg Hd Hout H0 t Ht. apply Rnot_lt_le. intros Hpos.
  assert (Hcont : forall s, 0 <= s -> continuity_pt g s).
  { intros s Hs. apply derivable_continuous_pt. exists (dg s). apply is_derive_Reals. now apply Hd. }
  (* The last time at which it was not positive. *)
  set (E := fun s => 0 <= s <= t /\ g s <= 0).
  destruct (completeness E) as (last & Hub & Hleast).
  - exists t. intros s Hs. apply Hs.
  - exists 0. repeat split; lra.
  - assert (Hlast : 0 <= last <= t).
    { split; [apply Hub; repeat split; lra | apply Hleast; intros s Hs; apply Hs]. }
    assert (Hafter : forall s, last < s <= t -> 0 < g s).
    { intros s Hs. apply Rnot_le_lt. intros Hle.
      assert (s <= last) by (apply Hub; repeat split; lra). lra. }
    assert (Hat : g last <= 0).
    { apply Rnot_lt_le. intros Hgt.
      destruct (Hcont last (proj1 Hlast) (g last) Hgt) as (d & Hdpos & Hnear).
      assert (Hbound : is_upper_bound E (last - d / 2)).
      { intros s (Hs & Hgs). apply Rnot_lt_le. intros Hlt.
        assert (s <= last) by (apply Hub; split; assumption).
        destruct (Req_dec s last) as [->|Hne]; [lra|].
        assert (Hclose : Rabs (g s - g last) < g last).
        { apply Hnear. split; [split; [exact I | lra]|]. cbn. unfold R_dist.
          rewrite Rabs_left; lra. }
        unfold Rabs in Hclose. destruct (Rcase_abs (g s - g last)); lra. }
      specialize (Hleast _ Hbound). lra. }
    assert (Hfall : - g last <= - g t).
    { apply (does_not_fall (fun s => - g s) (fun s => - dg s) last t (proj2 Hlast)).
      - intros s Hs. apply @is_derive_opp. apply Hd. lra.
      - intros s Hs. assert (dg s <= 0) by (apply Hout; [lra | apply Hafter; lra]). lra. }
    lra.
Qed.

(** What is not turned outwards beyond a length never passes it. *)
Theorem length_is_bounded : forall (p p_1 : R -> space) most, (forall s, 0 <= s -> moves p s (p_1 s)) ->
  (forall s, 0 <= s -> most * most < square (p s) -> dot (p s) (p_1 s) <= 0) ->
  square (p 0) <= most * most -> forall t, 0 <= t -> square (p t) <= most * most.
Proof.
  intros p p_1 most Hp Hin H0 t Ht. enough (square (p t) - most * most <= 0) by lra.
  apply (never_positive (fun s => square (p s) - most * most) (fun s => 2 * dot (p s) (p_1 s)));
    [intros s Hs | intros s Hs Hout | lra | lra].
  - eapply derive_as; [|apply Rminus_0_r].
    apply derive_difference; [|apply derive_constant]. unfold square.
    eapply derive_as; [exact (moves_dot _ _ _ _ _ (Hp s Hs) (Hp s Hs)) | components; ring].
  - specialize (Hin s Hs ltac:(lra)). lra.
Qed.

(** So the rate p of the thrust direction never passes Omega: the last step takes
    a share of the third's. In the axes of the frame, which turns about rho by W,
    p' is the limiter's q, carried by W: q + W (p_2, -p_1). Whatever is wanted,
    whatever share there is, whatever W, alpha and the cone are. *)
Theorem rate_of_the_limiter : forall (p wanted across : R -> space) (W share alpha along : R -> R)
    period rate_max closing cosine,
  0 < period -> 0 <= rate_max -> (forall s, 0 <= s -> 0 <= share s /\ 0 <= alpha s) ->
  let q s := limited (p s) (wanted s) period (alpha s) rate_max closing cosine (across s) (along s) (share s) in
  (forall s, 0 <= s -> moves p s (add (q s) (scaled (W s) (quarter (p s))))) ->
  square (p 0) <= rate_max * rate_max -> forall t, 0 <= t -> square (p t) <= rate_max * rate_max.
Proof.
  intros p wanted across W share alpha along period rate_max closing cosine Hh Hmax Hshare q Hp H0.
  refine (length_is_bounded _ _ rate_max Hp _ H0). intros s Hs Hout.
  pose proof (share_turns_inwards (p s) (wanted s) period (alpha s) rate_max closing cosine (across s) (along s)
    (proj2 (Hshare s Hs)) Hmax Hh (share s) (proj1 (Hshare s Hs)) Hout) as Hin. fold (q s) in Hin.
  replace (dot (p s) (add (q s) (scaled (W s) (quarter (p s))))) with (dot (p s) (q s))
    by (unfold quarter; components; ring). exact Hin.
Qed.
