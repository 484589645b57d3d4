(** * Every rotor stays within its range

    Sections 4 and 8 of docs/extended-law.md, in exact arithmetic.
    controller-core/src/extended/thrust_range.rs holds [floor], [ceiling] and
    [thrust]; controller-core/src/extended/budget.rs holds the rows.

    A rotor's command is f = b (T + beta . tau) with b > 0. The law chooses tau
    first; [rows_hold] says what the certificate's last two rows and the budget
    of a tick promise of it: Tick.v proves that. T is then the nearest to the
    wanted thrust between [floor] and [ceiling]. *)

From Coq Require Import Reals Lra List.
Import ListNotations.
Open Scope R_scope.

Record torque := { about_x : R; about_y : R; about_z : R }.

(** A rotor: b (thrust per collective thrust), beta = b_tau / b, and its
    range, N. *)
Record rotor := { b : R; beta : torque; least : R; greatest : R }.

Definition dot (u v : torque) : R :=
  about_x u * about_x v + about_y u * about_y v + about_z u * about_z v.

(** The command for a rotor, N. *)
Definition command (r : rotor) (T : R) (tau : torque) : R :=
  b r * (T + dot (beta r) tau).

Section Law.

Variables (s margin T_max : R) (rotors : list rotor) (tau : torque).

Definition needs (r : rotor) : R := s * least r / b r - dot (beta r) tau + margin.
Definition gives (r : rotor) : R := s * greatest r / b r - dot (beta r) tau - margin.

(** N(tau) and C(tau): section 8. Both begin as the code does. *)
Definition floor : R := fold_right (fun r n => Rmax (needs r) n) margin rotors.
Definition ceiling : R := fold_right (fun r c => Rmin (gives r) c) T_max rotors.

(** T for a wanted thrust. *)
Definition thrust (wanted : R) : R := Rmin (Rmax wanted floor) ceiling.

Lemma floor_covers : forall r, In r rotors -> needs r <= floor.
Proof.
  unfold floor. induction rotors as [|r' rest IH]; intros r H; [contradiction|].
  destruct H as [<-|H]; cbn.
  - apply Rmax_l.
  - eapply Rle_trans; [apply IH, H | apply Rmax_r].
Qed.

Lemma ceiling_covers : forall r, In r rotors -> ceiling <= gives r.
Proof.
  unfold ceiling. induction rotors as [|r' rest IH]; intros r H; [contradiction|].
  destruct H as [<-|H]; cbn.
  - apply Rmin_l.
  - eapply Rle_trans; [apply Rmin_r | apply IH, H].
Qed.

Lemma ceiling_greatest : forall m,
  m <= T_max -> (forall r, In r rotors -> m <= gives r) -> m <= ceiling.
Proof.
  unfold ceiling. induction rotors as [|r' rest IH]; intros m Hm H; cbn; [exact Hm|].
  apply Rmin_glb.
  - apply H. now left.
  - apply IH; [exact Hm|]. intros r Hr. apply H. now right.
Qed.

Lemma ceiling_within_limit : ceiling <= T_max.
Proof.
  unfold ceiling. induction rotors as [|r rest IH]; cbn; [lra|].
  eapply Rle_trans; [apply Rmin_r | exact IH].
Qed.

(** What the torque has to leave, pair by pair: no rotor needs more than any
    gives. So N <= C, but for the margin that N begins with: where C is less
    than that, T is C. *)
Definition torque_fits : Prop :=
  (forall r, In r rotors -> needs r <= T_max) /\
  (forall r r', In r rotors -> In r' rotors -> needs r <= gives r').

(** The first claim: whatever thrust is wanted, every rotor is within its
    range, by the margin. *)
Theorem rotors_within_range : forall wanted,
  (forall r, In r rotors -> 0 < b r) -> torque_fits ->
  forall r, In r rotors ->
    s * least r + b r * margin <= command r (thrust wanted) tau
    <= s * greatest r - b r * margin
    /\ thrust wanted <= T_max.
Proof.
  intros wanted Hb (Ht & Hp) r Hr.
  pose proof (floor_covers r Hr) as Hn.
  pose proof (ceiling_covers r Hr) as Hc.
  pose proof ceiling_within_limit as Hmax.
  pose proof (Hb r Hr) as Hbr.
  assert (Hlow : needs r <= thrust wanted).
  { unfold thrust. apply Rmin_glb.
    - eapply Rle_trans; [exact Hn | apply Rmax_r].
    - apply ceiling_greatest; [now apply Ht|]. intros r' Hr'. now apply Hp. }
  assert (Hhigh : thrust wanted <= gives r).
  { unfold thrust. eapply Rle_trans; [apply Rmin_r | exact Hc]. }
  assert (Hlimit : thrust wanted <= T_max).
  { unfold thrust. eapply Rle_trans; [apply Rmin_r | exact Hmax]. }
  split; [|exact Hlimit].
  unfold needs, gives in *. unfold command.
  apply Rmult_le_compat_l with (r := b r) in Hlow; [|lra].
  apply Rmult_le_compat_l with (r := b r) in Hhigh; [|lra].
  replace (b r * (s * least r / b r - dot (beta r) tau + margin))
    with (s * least r - b r * dot (beta r) tau + b r * margin) in Hlow by (field; lra).
  replace (b r * (s * greatest r / b r - dot (beta r) tau - margin))
    with (s * greatest r - b r * dot (beta r) tau - b r * margin) in Hhigh by (field; lra).
  lra.
Qed.

End Law.

(** ** The certificate's rows make every torque fit: section 4 *)

Definition tilt_length (v : torque) : R := sqrt (about_x v * about_x v + about_y v * about_y v).

Lemma tilt_length_nonneg : forall v, 0 <= tilt_length v.
Proof. intros. apply sqrt_pos. Qed.

(** Cauchy and Schwarz, about the tilt's axes. *)
Lemma tilt_dot : forall u v,
  Rabs (about_x u * about_x v + about_y u * about_y v) <= tilt_length u * tilt_length v.
Proof.
  intros u v. unfold tilt_length. rewrite <- sqrt_mult_alt.
  - rewrite <- sqrt_Rsqr_abs. apply sqrt_le_1_alt. unfold Rsqr.
    pose proof (Rle_0_sqr (about_x u * about_y v - about_y u * about_x v)) as H.
    unfold Rsqr in H. nra.
  - nra.
Qed.

Lemma abs_bounds : forall a c, Rabs a <= c -> - c <= a <= c.
Proof. intros a c H. unfold Rabs in H. destruct (Rcase_abs a); lra. Qed.

Lemma dot_bound : forall u v t y,
  tilt_length u <= t -> Rabs (about_z u) <= y ->
  Rabs (dot u v) <= t * tilt_length v + y * Rabs (about_z v).
Proof.
  intros u v t y Ht Hy. unfold dot.
  eapply Rle_trans; [apply Rabs_triang|].
  apply Rplus_le_compat.
  - eapply Rle_trans; [apply tilt_dot|].
    apply Rmult_le_compat_r; [apply tilt_length_nonneg | exact Ht].
  - rewrite Rabs_mult. apply Rmult_le_compat_r; [apply Rabs_pos | exact Hy].
Qed.

Definition minus (u v : torque) : torque :=
  {| about_x := about_x u - about_x v;
     about_y := about_y u - about_y v;
     about_z := about_z u - about_z v |}.

Lemma dot_minus : forall u v w, dot (minus u v) w = dot u w - dot v w.
Proof. intros. unfold dot, minus. cbn. ring. Qed.

Section Rows.

Variables (s_lo s_hi margin T_max : R) (rotors : list rotor).
(** The right sides' parts: the least s_lo f_max / b and the greatest
    s_hi f_min / b. *)
Variables (range_top range_bottom : R).

Hypothesis b_positive : forall r, In r rotors -> 0 < b r.
Hypothesis ranges : forall r, In r rotors -> 0 <= least r /\ 0 <= greatest r.
Hypothesis range_top_least : forall r, In r rotors -> range_top <= s_lo * greatest r / b r.
Hypothesis range_bottom_greatest : forall r, In r rotors -> s_hi * least r / b r <= range_bottom.
Hypothesis margin_nonneg : 0 <= margin.

(** Both rows, for the torque at hand: "two rotors at their ends at once" and
    "the thrust floor and T_max". [parts_add_up] of Budget.v bounds the left
    sides by what the rows count. *)
Definition rows_hold (tau : torque) : Prop :=
  (forall r r', In r rotors -> In r' rotors ->
     Rabs (dot (minus (beta r) (beta r')) tau) <= range_top - range_bottom - 2 * margin)
  /\ (forall r, In r rotors -> Rabs (dot (beta r) tau) <= T_max - range_bottom - 2 * margin).

Lemma scale_monotone : forall s x, s_lo <= s <= s_hi -> 0 <= x -> s_lo * x <= s * x <= s_hi * x.
Proof. intros s x Hs Hx. split; apply Rmult_le_compat_r; lra. Qed.

Lemma over_b : forall x y r, In r rotors -> x <= y -> x / b r <= y / b r.
Proof.
  intros x y r Hr H. unfold Rdiv. apply Rmult_le_compat_r; [|exact H].
  left. apply Rinv_0_lt_compat, b_positive, Hr.
Qed.

Theorem rows_suffice : forall s tau,
  s_lo <= s <= s_hi -> rows_hold tau -> torque_fits s margin T_max rotors tau.
Proof.
  intros s tau Hs (Hpair & Hfloor).
  assert (Hlow : forall r, In r rotors -> s * least r / b r <= range_bottom).
  { intros r Hr. eapply Rle_trans; [|apply range_bottom_greatest, Hr].
    apply over_b; [exact Hr|]. apply (scale_monotone s); [exact Hs | apply (ranges r Hr)]. }
  assert (Hhigh : forall r, In r rotors -> range_top <= s * greatest r / b r).
  { intros r Hr. eapply Rle_trans; [apply range_top_least, Hr|].
    apply over_b; [exact Hr|]. apply (scale_monotone s); [exact Hs | apply (ranges r Hr)]. }
  assert (Hneeds : forall r, In r rotors -> needs s margin tau r <= T_max).
  { intros r Hr. unfold needs. pose proof (Hlow r Hr).
    pose proof (Hfloor r Hr) as Hd. apply abs_bounds in Hd. lra. }
  assert (Hpairs : forall r r', In r rotors -> In r' rotors -> needs s margin tau r <= gives s margin tau r').
  { intros r r' Hr Hr'. unfold needs, gives.
    pose proof (Hlow r Hr). pose proof (Hhigh r' Hr').
    pose proof (Hpair r' r Hr' Hr) as Hd. apply abs_bounds in Hd. rewrite dot_minus in Hd. lra. }
  split; [exact Hneeds | exact Hpairs].
Qed.

(** Claim (d) of section 4 as a whole: a torque that keeps the rows, with any
    wanted thrust and any scale within its levels, takes no rotor out of its
    range. *)
Theorem no_rotor_beyond_its_range : forall s tau wanted,
  s_lo <= s <= s_hi -> rows_hold tau ->
  forall r, In r rotors ->
    s * least r + b r * margin <= command r (thrust s margin T_max rotors tau wanted) tau
    <= s * greatest r - b r * margin
    /\ thrust s margin T_max rotors tau wanted <= T_max.
Proof.
  intros s tau wanted Hs Hrows. apply rotors_within_range;
    [exact b_positive | now apply rows_suffice].
Qed.

End Rows.
